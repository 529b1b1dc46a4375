#include "edit/export/chosen_objects.h"

#include <algorithm>
#include <cctype>

#include "core/error.h"
#include "edit/export/object_meshes.h"
#include "edit/object_names.h"
#include "gaussians/instances.h"

namespace aligngs {
namespace {

bool among(const std::vector<SelectionTerm>& terms, int label, int instance) {
  return std::any_of(terms.begin(), terms.end(), [&](const SelectionTerm& t) {
    return t.label == label && (t.instance == 0 || t.instance == instance);
  });
}

bool means(const SelectionQuery& query, int label, int instance) {
  return (query.everything || among(query.include, label, instance)) && !among(query.exclude, label, instance);
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// "pillow.002", the name of a node in an export, becomes "pillow#2". Numbers that a letter follows stay as they are.
std::string with_object_numbers(const std::string& text) {
  std::string out;
  for (size_t i = 0; i < text.size(); ++i) {
    size_t end = i + 1;
    while (end < text.size() && is_digit(text[end])) ++end;
    const bool inside_word =
        end < text.size() && (std::isalnum(static_cast<unsigned char>(text[end])) || text[end] == '_');
    if (text[i] != '.' || end == i + 1 || inside_word) {
      out += text[i];
      continue;
    }
    size_t first = i + 1;
    while (first + 1 < end && text[first] == '0') ++first;
    out += "#" + text.substr(first, end - first);
    i = end - 1;
  }
  return out;
}

}  // namespace

EditableRoom chosen_objects(const EditableRoom& room, const std::string& text, ThreadPool& pool) {
  const SelectionQuery query = read_selection(room, with_object_numbers(text));
  for (const auto* terms : {&query.include, &query.exclude}) {
    for (const SelectionTerm& term : *terms) {
      if (!term.named.empty()) {
        throw_usage("--object takes classes and objects, and \"" + term.named + "\" was drawn by hand",
                    "make a run of it: aligngs edit RUN --select \"" + term.named + "\" --extract -o NEW_RUN");
      }
    }
  }
  const GaussianLabels& labels = room.gaussians.labels;
  std::vector<uint8_t> keep(room.gaussians.model.size());
  for (size_t i = 0; i < keep.size(); ++i)
    keep[i] = means(query, labels.label[i] == kNoLabel ? -1 : labels.label[i], labels.instance[i]);
  EditableRoom out;
  out.labels = room.labels;
  out.up = room.up;
  out.cameras = room.cameras;
  for (ObjectMesh& object : room.mesh.empty() ? std::vector<ObjectMesh>() : object_meshes(room, pool)) {
    if (!means(query, object.label, object.instance)) continue;
    const uint32_t base = static_cast<uint32_t>(out.mesh.vertices.size());
    const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    append(out.mesh.vertices, object.mesh.vertices);
    append(out.mesh.normals, object.mesh.normals);
    append(out.mesh.colors, object.mesh.colors);
    out.mesh.labels.resize(out.mesh.vertices.size(), object.label < 0 ? kNoLabel : static_cast<uint16_t>(object.label));
    for (const auto& t : object.mesh.triangles) out.mesh.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  }
  if (out.mesh.empty() && std::find(keep.begin(), keep.end(), 1) == keep.end()) {
    throw_bad_input({}, "--object", "this room has no \"" + text + "\"",
                    "it has " + objects_text(list_instances(room.gaussians.model, labels), room.labels));
  }
  out.gaussians = keep_rows(room.gaussians, keep);
  for (size_t i = 0; i < keep.size(); ++i) {
    if (keep[i]) out.origins.push_back(room.origins[i]);
  }
  return out;
}

}  // namespace aligngs
