// Objects that a colour or a narrower name leaves: "the red chair", "the floor lamp".
#pragma once

#include <string>
#include <vector>

#include "edit/relation/color_words.h"
#include "edit/relation/object_relations.h"
#include "edit/selection_term.h"

namespace aligngs {

/// The middle colour of an object's solid Gaussians.
SeenColor color_of(const RoomObjects& objects, size_t object);

/// Those of the colour of a term. Error{kBadInput} where none is, or where some are only nearly of it. `what` is in the
/// message.
std::vector<size_t> of_color(const RoomObjects& objects, const std::vector<size_t>& candidates,
                             const SelectionTerm& term, const std::string& what);

/// Those in the place that a narrower name tells. A single candidate is kept in any place. Error{kBadInput} where none
/// is there.
std::vector<size_t> of_narrow_name(const RoomObjects& objects, const ObjectRelations& relations,
                                   const std::vector<size_t>& candidates, NarrowPlace place);

}  // namespace aligngs
