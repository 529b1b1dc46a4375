#include "train/run_outputs.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "gaussians/instances.h"
#include "io/atomic_file.h"
#include "io/json_text.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

using Json = nlohmann::ordered_json;

Json objects_json(const std::vector<Instance>& instances, int label) {
  Json objects = Json::array();
  for (const Instance& object : instances) {
    if (object.label != label) continue;
    objects.push_back({{"instance", object.number},
                       {"gaussians", object.gaussians},
                       {"centre", {object.centre.x, object.centre.y, object.centre.z}},
                       {"min", {object.low.x, object.low.y, object.low.z}},
                       {"max", {object.high.x, object.high.y, object.high.z}}});
  }
  return objects;
}

void write_classes(const std::filesystem::path& path, const GaussianModel& model, const LabelSet& labels,
                   const GaussianLabels& assigned) {
  const std::vector<Instance> instances = list_instances(model, assigned);
  Json classes = Json::array();
  for (int i = 0; i < labels.size(); ++i) {
    const LabelClass& c = labels.classes[static_cast<size_t>(i)];
    const auto count = std::count(assigned.label.begin(), assigned.label.end(), static_cast<uint16_t>(i));
    Json entry = {{"id", i}, {"name", c.name}, {"synonyms", c.synonyms}, {"color", c.color}, {"gaussians", count}};
    if (count > 0) entry["objects"] = objects_json(instances, i);
    classes.push_back(entry);
  }
  const Json document = {{"schema", 1}, {"label_set", labels.name}, {"classes", classes}};
  write_file_atomically(path, json_document(document));
}

}  // namespace

void write_label_files(const std::filesystem::path& folder, const GaussianModel& model, const LabelSet& labels,
                       const GaussianLabels& assigned) {
  if (assigned.label.empty()) return;
  write_labelled_gaussian_ply(folder / "scene.labels.ply", model, assigned);
  write_classes(folder / "classes.json", model, labels, assigned);
}

void write_scene_files(const std::filesystem::path& folder, const GaussianModel& model, const LabelSet& labels,
                       const GaussianLabels& assigned) {
  write_gaussian_ply(folder / "scene.ply", model);
  write_label_files(folder, model, labels, assigned);
}

}  // namespace aligngs
