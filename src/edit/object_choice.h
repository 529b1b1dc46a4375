// "the largest chair", "the left pillow": which of some objects is meant.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "edit/relation/room_objects.h"
#include "edit/selection_words.h"

namespace aligngs {

/// The object of `candidates`, which are not empty. Largest and smallest compare the volume of the boxes
/// (object_box.h), tallest and shortest their heights, widest and narrowest their longer level side. Highest and lowest
/// compare the middles. Left and right are as a person sees who is at the mean place of the cameras, and looks at the
/// middle of the candidates. Error{kBadInput} where a direction is not known, where candidates are behind that person,
/// and where two candidates are nearly equal. `what` is named there.
/// Walls, floor and ceiling are refused: all walls are mostly one object. `rank` is 2 for the second
/// largest.
size_t chosen_object(const RoomObjects& objects, const std::vector<size_t>& candidates, ObjectChoice choice,
                     const std::string& what, size_t rank = 1);
/// The first `count` of them: "the two largest pillows". There are more candidates than that.
std::vector<size_t> chosen_objects(const RoomObjects& objects, const std::vector<size_t>& candidates,
                                   ObjectChoice choice, size_t count, const std::string& what);

}  // namespace aligngs
