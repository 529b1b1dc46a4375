#include "train/run_outputs.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "io/atomic_file.h"
#include "scene/triangle_mesh.h"
#include "train/camera_outputs.h"

namespace aligngs {
namespace {

using Json = nlohmann::ordered_json;

void write_json(const std::filesystem::path& path, const Json& json) {
  write_file_atomically(path, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

void write_classes(const std::filesystem::path& path, const LabelSet& labels, const GaussianLabels& assigned) {
  std::vector<size_t> counts(labels.classes.size(), 0);
  for (const uint16_t label : assigned.label) {
    if (label < counts.size()) ++counts[label];
  }
  Json classes = Json::array();
  for (size_t i = 0; i < labels.classes.size(); ++i) {
    const LabelClass& c = labels.classes[i];
    classes.push_back({{"id", i}, {"name", c.name}, {"synonyms", c.synonyms}, {"color", c.color}, {"gaussians", counts[i]}});
  }
  write_json(path, {{"schema", 1}, {"label_set", labels.name}, {"classes", classes}});
}

}  // namespace

GaussianLabels label_gaussians(const GaussianModel& model, const LabelSet& labels) {
  const size_t n = model.size(), channels = static_cast<size_t>(model.semantic_channels);
  GaussianLabels out;
  out.label_set = labels.name;
  out.label.assign(n, kNoLabel);
  out.instance.assign(n, 0);
  out.confidence.assign(n, 0);
  for (size_t i = 0; i < n && channels > 0; ++i) {
    const float* s = &model.semantics[i * channels];
    const float* best = std::max_element(s, s + channels);
    if (*best == *std::min_element(s, s + channels)) continue;  // never seen: the row is as it began
    double sum = 0;
    for (size_t c = 0; c < channels; ++c) sum += std::exp(static_cast<double>(s[c]) - *best);
    out.label[i] = static_cast<uint16_t>(best - s);
    out.confidence[i] = static_cast<uint8_t>(std::lround(255.0 / sum));
  }
  return out;
}

void write_run_outputs(const RunFolder& folder, const GaussianModel& model, const Scene& scene, const TrainConfig& config) {
  write_gaussian_ply(folder.scene_ply(), model);
  if (model.semantic_channels > 0) {
    const GaussianLabels labels = label_gaussians(model, scene.labels);
    write_labelled_gaussian_ply(folder.labelled_ply(), model, labels);
    write_classes(folder.classes(), scene.labels, labels);
  }
  write_camera_outputs(folder, scene, config);
}

}  // namespace aligngs
