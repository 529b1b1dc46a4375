// An object that comes from elsewhere: a file of splats, or an object of another run.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "core/thread_pool.h"
#include "edit/apply_edit.h"
#include "edit/edit_change.h"
#include "edit/up_axis.h"

namespace aligngs {

struct InsertedObject {
  EditableRoom room;           ///< its Gaussians, and its mesh where it has one; in a world of its own
  std::string class_name;      ///< "armchair"; empty: it has none
  Vec3d up;                    ///< unit, in that world
  std::optional<Vec3d> front;  ///< unit, level: away from the wall behind it; empty: it has no wall
  std::optional<bool> metric;  ///< whether its unit is the metre; empty: nobody knows
  bool placed = false;         ///< it is in the world of the room already, where an edit put it
};

/// Whether the source of an object is FILE.ply, and not RUN#OBJECT.
bool is_splat_file(const std::string& source);

/// FILE.ply: splats in the common layout of 3DGS, with or without labels. `up` is an axis of the file. The front is the
/// file's -y where z or -z is up, else its z. RUN#OBJECT: the object of a run with its edits, e.g. "other_run#armchair#1".
/// Error{kUsage} for other words and for a run without such an object. Error{kBadInput} for a damaged file, and for one
/// without Gaussians or with more than 20 million.
InsertedObject read_inserted_object(const std::string& source, UpAxis up, ThreadPool& pool);

/// The object that an edit put into a room, as the file of the edit has it; null for other edits.
std::shared_ptr<const InsertedObject> inserted_by(const EditChange& change, const EditableRoom& room);

/// Normal of the wall behind the selected Gaussians, into the room. Empty when none is within 15 % of the extent, which
/// is about 45 cm.
std::optional<Vec3d> wall_behind(const EditableRoom& room, const std::vector<uint8_t>& selected);

}  // namespace aligngs
