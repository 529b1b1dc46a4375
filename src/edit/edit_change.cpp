#include "edit/edit_change.h"

#include <algorithm>
#include <cstring>

#include "core/append.h"
#include "core/kept_rows.h"
#include "edit/apply_edit.h"
#include "edit/mesh_rows.h"
#include "edit/mesh_selection.h"
#include "edit/recolor.h"

namespace aligngs {
namespace {

constexpr size_t kHarmonics = size_t(3) * kShCoefficients;

/// Names of `before` that `after` does not have; calls pair(b, a) for those that both have. Both ascend.
template <class Before, class After, class Pair>
std::vector<RowId> compare(size_t before, const Before& id_before, size_t after, const After& id_after,
                           const Pair& pair) {
  std::vector<RowId> gone;
  size_t a = 0;
  for (size_t b = 0; b < before; ++b) {
    while (a < after && id_after(a) < id_before(b)) ++a;
    if (a < after && id_after(a) == id_before(b)) {
      pair(b, a);
    } else {
      gone.push_back(id_before(b));
    }
  }
  return gone;
}

/// Rows of the names in `wanted`; false when one is not there. Both ascend.
template <class Id>
bool find_rows(const std::vector<RowId>& wanted, size_t count, const Id& id, std::vector<uint32_t>& rows) {
  rows.clear();
  rows.reserve(wanted.size());
  size_t i = 0;
  for (const RowId name : wanted) {
    while (i < count && id(i) < name) ++i;
    if (i == count || id(i) != name) return false;
    rows.push_back(static_cast<uint32_t>(i));
  }
  return true;
}

template <class T>
void append_row(std::vector<T>& to, const std::vector<T>& from, size_t row, size_t width) {
  to.insert(to.end(), from.begin() + static_cast<std::ptrdiff_t>(row * width),
            from.begin() + static_cast<std::ptrdiff_t>((row + 1) * width));
}

/// Collects what a change touches.
class Touched {
 public:
  explicit Touched(EditChange& change) : change_(change), seen_(size_t(1) << 16, 0) {}
  ~Touched() {
    for (size_t label = 0; label < seen_.size(); ++label) {
      if (seen_[label]) change_.classes.push_back(static_cast<uint16_t>(label));
    }
  }
  void add(const EditableRoom& room, size_t row) {
    for (int a = 0; a < 3; ++a) {
      const float p = room.gaussians.model.positions[3 * row + static_cast<size_t>(a)];
      change_.low[a] = std::min(change_.low[a], p);
      change_.high[a] = std::max(change_.high[a], p);
    }
    seen_[room.gaussians.labels.label[row]] = 1;
  }

 private:
  EditChange& change_;
  std::vector<uint8_t> seen_;
};

void add_gaussians(const EditableRoom& after, EditChange& change, Touched& touched) {
  const GaussianModel& m = after.gaussians.model;
  AddedGaussians& out = change.added;
  for (size_t i = 0; i < after.origins.size(); ++i) {
    if (after.origins[i].id != kNewRow) continue;
    append_row(out.model.positions, m.positions, i, 3);
    append_row(out.model.log_scales, m.log_scales, i, 3);
    append_row(out.model.rotations, m.rotations, i, 4);
    append_row(out.model.opacity_logits, m.opacity_logits, i, 1);
    append_row(out.model.sh, m.sh, i, kHarmonics);
    out.label.push_back(after.gaussians.labels.label[i]);
    out.instance.push_back(after.gaussians.labels.instance[i]);
    out.confidence.push_back(after.gaussians.labels.confidence[i]);
    out.source.push_back(after.origins[i].row);
    touched.add(after, i);
  }
}

void compare_meshes(const EditableRoom& before, const EditableRoom& after, EditChange& change) {
  const MeshRows &b = before.mesh_rows, &a = after.mesh_rows;
  const auto vertex_before = [&](size_t i) { return b.vertices[i]; };
  const auto vertex_after = [&](size_t i) { return a.vertices[i]; };
  change.removed_triangles = compare(
      b.triangles.size(), [&](size_t i) { return b.triangles[i]; }, a.triangles.size(),
      [&](size_t i) { return a.triangles[i]; }, [](size_t, size_t) {});
  compare(b.vertices.size(), vertex_before, a.vertices.size(), vertex_after, [&](size_t i, size_t j) {
    if (before.mesh.colors.empty() || before.mesh.colors[i] == after.mesh.colors[j]) return;
    change.recolored_vertices.push_back(b.vertices[i]);
    change.vertex_colors.push_back(after.mesh.colors[j]);
  });
  std::vector<uint32_t> fresh;
  for (uint32_t i = 0; i < a.triangles.size(); ++i) {
    if (a.triangles[i] == kNewRow) fresh.push_back(i);
  }
  change.added_mesh = submesh(after.mesh, fresh);
}

bool apply_to_mesh(EditableRoom& room, const EditChange& change, const std::vector<uint32_t>& gone,
                   const std::vector<uint32_t>& recolored) {
  for (size_t k = 0; k < recolored.size(); ++k) room.mesh.colors[recolored[k]] = change.vertex_colors[k];
  if (!gone.empty()) {
    std::vector<uint32_t> stay;
    size_t next = 0;
    for (uint32_t i = 0; i < room.mesh.triangles.size(); ++i) {
      if (next < gone.size() && gone[next] == i) {
        ++next;
      } else {
        stay.push_back(i);
      }
    }
    SubmeshRows rows;
    room.mesh = submesh(room.mesh, stay, &rows);
    for (size_t i = 0; i < rows.vertices.size(); ++i)
      room.mesh_rows.vertices[i] = room.mesh_rows.vertices[rows.vertices[i]];
    for (size_t i = 0; i < rows.triangles.size(); ++i)
      room.mesh_rows.triangles[i] = room.mesh_rows.triangles[rows.triangles[i]];
    room.mesh_rows.vertices.resize(rows.vertices.size());
    room.mesh_rows.triangles.resize(rows.triangles.size());
  }
  const size_t vertices = room.mesh.vertices.size(), triangles = room.mesh.triangles.size();
  append_mesh(room, change.added_mesh);
  for (size_t i = vertices; i < room.mesh.vertices.size(); ++i)
    room.mesh_rows.vertices[i] = row_of_edit(change.number, static_cast<uint32_t>(i - vertices));
  for (size_t i = triangles; i < room.mesh.triangles.size(); ++i)
    room.mesh_rows.triangles[i] = row_of_edit(change.number, static_cast<uint32_t>(i - triangles));
  return true;
}

void remove_gaussians(EditableRoom& room, const std::vector<uint32_t>& gone) {
  if (gone.empty()) return;
  std::vector<uint8_t> stays(room.origins.size(), 1);
  for (const uint32_t i : gone) stays[i] = 0;
  room.gaussians = keep_rows(std::move(room.gaussians), stays);
  room.origins = kept_rows(room.origins, stays, 1);
}

void append_gaussians(EditableRoom& room, const EditChange& change) {
  const AddedGaussians& more = change.added;
  GaussianModel& m = room.gaussians.model;
  append_exactly(m.positions, more.model.positions);
  append_exactly(m.log_scales, more.model.log_scales);
  append_exactly(m.rotations, more.model.rotations);
  append_exactly(m.opacity_logits, more.model.opacity_logits);
  append_exactly(m.sh, more.model.sh);
  m.semantics.resize(m.size() * static_cast<size_t>(m.semantic_channels));
  append_exactly(room.gaussians.labels.label, more.label);
  append_exactly(room.gaussians.labels.instance, more.instance);
  append_exactly(room.gaussians.labels.confidence, more.confidence);
  room.origins.reserve(room.origins.size() + more.size());
  for (uint32_t i = 0; i < more.size(); ++i)
    room.origins.push_back({more.source[i], true, row_of_edit(change.number, i)});
}

class Digest {
 public:
  template <class T>
  void add(const std::vector<T>& values) {
    add(values.size());
    const char* bytes = reinterpret_cast<const char*>(values.data());
    const size_t size = values.size() * sizeof(T);
    for (size_t at = 0; at < size; at += sizeof(uint64_t)) {
      uint64_t word = 0;
      std::memcpy(&word, bytes + at, std::min(sizeof word, size - at));
      add(word);
    }
  }
  uint64_t value() const { return state_; }

 private:
  void add(uint64_t word) {  // multiply and fold, as in splitmix64
    state_ = (state_ ^ word) * 0x9e3779b97f4a7c15u;
    state_ ^= state_ >> 29;
  }
  uint64_t state_ = 0x243f6a8885a308d3u;
};

}  // namespace

EditChange difference(const EditableRoom& before, const EditableRoom& after, const EditOperation& edit,
                      const EditReport& report, uint32_t number, uint64_t base) {
  EditChange change;
  change.number = number;
  change.base = base;
  change.asked = report.asked;
  change.asked_everything = report.asked_everything;
  change.inserted = report.inserted;
  change.inserted_triangles = report.inserted_triangles;
  const GaussianLabels &labels = before.gaussians.labels, &labels_now = after.gaussians.labels;
  ColorChange color{edit.kind, edit.color, report.mean_luma.value_or(1.f), {}};
  const auto id_before = [&](size_t i) { return before.origins[i].id; };
  const auto id_after = [&](size_t i) { return after.origins[i].id; };
  {
    Touched touched(change);
    std::vector<uint8_t> stays(before.origins.size(), 0);
    change.removed = compare(before.origins.size(), id_before, after.origins.size(), id_after, [&](size_t b, size_t a) {
      stays[b] = 1;
      if (!report.recolored.empty() && report.recolored[b]) {
        color.rows.push_back(before.origins[b].id);
        touched.add(before, b);
      }
      if (labels.label[b] != labels_now.label[a] || labels.instance[b] != labels_now.instance[a]) {
        change.relabelled.push_back(before.origins[b].id);
        change.label.push_back(labels_now.label[a]);
        change.instance.push_back(labels_now.instance[a]);
        touched.add(before, b);
      }
    });
    for (size_t b = 0; b < stays.size(); ++b) {
      if (!stays[b]) touched.add(before, b);
    }
    add_gaussians(after, change, touched);
  }
  if (takes_color(edit.kind)) change.colors = std::move(color);
  compare_meshes(before, after, change);
  return change;
}

bool apply_change(EditableRoom& room, const EditChange& change) {
  const auto id = [&](size_t i) { return room.origins[i].id; };
  std::vector<uint32_t> gone, colored, relabelled, triangles, vertices;
  const MeshRows& mesh = room.mesh_rows;
  if (!find_rows(change.removed, room.origins.size(), id, gone)) return false;
  if (change.colors && !find_rows(change.colors->rows, room.origins.size(), id, colored)) return false;
  if (!find_rows(change.relabelled, room.origins.size(), id, relabelled)) return false;
  if (!find_rows(
          change.removed_triangles, mesh.triangles.size(), [&](size_t i) { return mesh.triangles[i]; }, triangles))
    return false;
  if (!find_rows(
          change.recolored_vertices, mesh.vertices.size(), [&](size_t i) { return mesh.vertices[i]; }, vertices))
    return false;

  for (size_t k = 0; k < relabelled.size(); ++k) {
    room.gaussians.labels.label[relabelled[k]] = change.label[k];
    room.gaussians.labels.instance[relabelled[k]] = change.instance[k];
  }
  if (change.colors) {
    std::vector<uint8_t> mask(room.origins.size(), 0);
    for (const uint32_t i : colored) mask[i] = 1;
    if (change.colors->kind == EditKind::kRecolor)
      recolor_gaussians(room.gaussians.model, mask, change.colors->color, change.colors->mean);
    else
      highlight_gaussians(room.gaussians.model, mask, change.colors->color);
  }
  // A change has no probabilities of what it adds. Whoever asks for them makes them for all Gaussians by their origins.
  if (!gone.empty() || change.added.size() > 0) room.gaussians.soft = {};
  remove_gaussians(room, gone);
  append_gaussians(room, change);
  apply_to_mesh(room, change, triangles, vertices);
  return true;
}

uint64_t gaussians_digest(const GaussianModel& model) {
  Digest digest;
  digest.add(model.positions);
  digest.add(model.opacity_logits);
  return digest.value();
}

uint64_t room_digest(const EditableRoom& room) {
  Digest digest;
  digest.add(room.gaussians.model.positions);
  digest.add(room.gaussians.model.sh);
  digest.add(room.gaussians.model.opacity_logits);
  digest.add(room.gaussians.labels.label);
  digest.add(room.gaussians.labels.instance);
  digest.add(room.mesh.vertices);
  digest.add(room.mesh.triangles);
  digest.add(room.mesh.colors);
  return digest.value();
}

}  // namespace aligngs
