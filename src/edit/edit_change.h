// Difference that one edit makes to a room: the rows that go, change and come. It is applied when a run is read.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "edit/apply_edit.h"

namespace aligngs {

/// New colours of Gaussians as a rule (recolor.h): 8 bytes a row instead of 192.
struct ColorChange {
  EditKind kind = EditKind::kRecolor;  ///< or kHighlight
  std::array<uint8_t, 3> color{};      ///< sRGB
  float mean = 1;                      ///< luma of the selection, for kRecolor
  std::vector<RowId> rows;             ///< ascending
};

/// Gaussians that come. Rows of the parts correspond.
struct AddedGaussians {
  GaussianModel model;  ///< without semantic rows
  std::vector<uint16_t> label, instance;
  std::vector<uint8_t> confidence;
  std::vector<uint32_t> source;  ///< row of the trained room whose class probabilities it has

  size_t size() const { return source.size(); }
};

/// All lists of rows are ascending.
struct EditChange {
  uint32_t number = 0;                                           ///< of the edit in its run, from 1 on
  uint64_t base = 0;                                             ///< digest of the trained room (room_digest)
  Vec3f low{1e30f, 1e30f, 1e30f}, high{-1e30f, -1e30f, -1e30f};  ///< box of all Gaussians that go, change and come
  std::vector<uint16_t> classes;                                 ///< of these Gaussians, ascending, each once
  std::vector<uint16_t> asked;                                   ///< classes that the selection names
  bool asked_everything = false;                                 ///< the selection is the room but for some classes

  std::vector<RowId> removed;
  std::optional<ColorChange> colors;
  std::vector<RowId> relabelled;
  std::vector<uint16_t> label, instance;  ///< of `relabelled`
  AddedGaussians added;
  uint64_t inserted = 0;            ///< so many of the last `added` are an object from elsewhere
  uint64_t inserted_triangles = 0;  ///< and so many of the last of `added_mesh`

  std::vector<RowId> removed_triangles;  ///< vertices that no triangle uses afterwards go as well
  std::vector<RowId> recolored_vertices;
  std::vector<std::array<uint8_t, 3>> vertex_colors;  ///< of `recolored_vertices`
  TriangleMesh added_mesh;
};

/// The change that apply_edit made to `before`. Rows of `after` that are new get the number of the edit.
EditChange difference(const EditableRoom& before, const EditableRoom& after, const EditOperation& edit,
                      const EditReport& report, uint32_t number, uint64_t base);

/// False, and an unchanged room, when rows that the change speaks of are not there.
bool apply_change(EditableRoom& room, const EditChange& change);

/// Digest of Gaussians. It tells whether a named selection is of them.
uint64_t gaussians_digest(const GaussianModel& model);

/// Digest of a trained room. It tells whether a change was made on it.
uint64_t room_digest(const EditableRoom& room);

}  // namespace aligngs
