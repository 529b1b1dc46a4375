// Carries out one edit on Gaussians and mesh alike.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/thread_pool.h"
#include "edit/edit_operation.h"
#include "edit/length_unit.h"
#include "edit/room_selections.h"
#include "edit/row_id.h"
#include "edit/selection.h"
#include "scene/camera.h"
#include "scene/triangle_mesh.h"

namespace aligngs {

/// Origin of a Gaussian of an edited room.
struct GaussianOrigin {
  uint32_t row = 0;     ///< row of the trained model
  bool filled = false;  ///< made by an edit; `row` is the one whose class it has
  RowId id = kNewRow;
};

/// A room with everything that edits change.
struct EditableRoom {
  LabelledGaussians gaussians;
  std::vector<GaussianOrigin> origins;  ///< per Gaussian
  TriangleMesh mesh;                    ///< empty when the run has none
  MeshRows mesh_rows;                   ///< names of its rows
  LabelSet labels;
  std::optional<Vec3d> up;                           ///< unit, world; when the scene knows it
  bool metric = false;                               ///< scene units are metres
  LengthUnit length_unit;                            ///< of lengths in warnings
  std::vector<Camera> cameras;                       ///< of the training photos, world; empty where they are not known
  std::shared_ptr<const RoomSelections> selections;  ///< drawn by hand; null: none
};

struct EditReport {
  std::string description;
  std::vector<SelectedObject> objects;        ///< what was selected
  std::vector<SelectedObject> contents;       ///< things on them that were left behind
  std::optional<SelectedObject> replacement;  ///< the object that came
  std::vector<std::string> absent;            ///< names of the selection of which the room has no object
  std::vector<std::string> warnings;          ///< sentences about what the edit did besides its words
  std::vector<SelectedObject> parts;          ///< things of other classes that belong to them and went along
  size_t selected = 0;                        ///< Gaussians
  size_t before = 0, after = 0;               ///< Gaussians of the room
  size_t filled = 0;                          ///< new Gaussians of the surfaces that were behind and under
  size_t cleared = 0;                         ///< Gaussians that went along, because only the object hid what they were
  size_t inserted = 0;                        ///< new Gaussians of an object from elsewhere
  size_t inserted_triangles = 0;
  bool no_support = false;  ///< fill was asked for and no surface continues into the hole
  size_t selected_vertices = 0, vertices_before = 0, vertices_after = 0;
  double threshold = 0;            ///< that was used; 0 for argmax
  std::optional<float> mean_luma;  ///< of the selection, for kRecolor; empty when nothing of it is to be seen
  std::vector<uint8_t> recolored;  ///< per Gaussian of the room before: 1 for those that kRecolor and kHighlight colour
  bool asked_everything = false;   ///< the selection is the room but for some classes
  std::vector<uint16_t> asked;     ///< classes that the selection names
};

/// Names and objects mean what they meant in the unedited room, whatever was deleted before. Error{kUsage} for names
/// that are unknown, Error{kBadInput} when nothing is selected or nothing would be left; the room is then unchanged.
EditReport apply_edit(EditableRoom& room, const EditOperation& edit, ThreadPool& pool);

/// Reads the text of a selection. "The largest chair" and "the pillow on the bed" have numbers then, among the objects
/// that the room has now. A selection by hand has its rows. Errors as parse_selection's, with_numbers'
/// (meant_objects.h) and with_rows'.
SelectionQuery read_selection(const EditableRoom& room, const std::string& text);

/// The words that people may use in this room: those of its label set, with suggestions of what it holds.
Vocabulary vocabulary_of(const EditableRoom& room);

/// The row subset of all parts of a labelled scene.
LabelledGaussians keep_rows(LabelledGaussians room, const std::vector<uint8_t>& keep);

}  // namespace aligngs
