#include "engine/prepare_view.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/half.h"
#include "core/is_depth.h"
#include "core/quantile.h"
#include "engine/edge_band.h"
#include "engine/formulas/teacher_sampling.h"
#include "scene/depth_normals.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

Image<uint8_t> label_band(const Image<uint16_t>& labels, int radius) {
  return edge_band(labels.width, labels.height, radius, [&](size_t i, size_t j) {
    return labels.data[i] != labels.data[j] && labels.data[i] != kNoLabel && labels.data[j] != kNoLabel;
  });
}

Image<uint8_t> depth_band(const ImageF& depth, const PrepareOptions& options) {
  return edge_band(depth.width, depth.height, options.edge_radius, [&](size_t i, size_t j) {
    const float a = depth.data[i], b = depth.data[j];
    return is_depth(a) && is_depth(b) && std::abs(a - b) > options.depth_jump * std::min(a, b);
  });
}

Image<uint8_t> color_band(const ImageF& color, const PrepareOptions& options) {
  return edge_band(color.width, color.height, options.edge_radius, [&](size_t i, size_t j) {
    float largest = 0;
    for (int c = 0; c < 3; ++c) largest = std::max(largest, std::abs(color.data[3 * i + c] - color.data[3 * j + c]));
    return largest > options.color_edge;
  });
}

// 1 - H / log C of every pixel of the teacher's own map, times its confidence.
std::vector<float> certainty(const SemanticTarget& target) {
  const size_t pixels = static_cast<size_t>(target.width) * target.height;
  const double most = std::log(static_cast<double>(target.channels));
  std::vector<float> out(pixels);
  for (size_t i = 0; i < pixels; ++i) {
    const uint16_t* t = &target.probabilities[i * target.channels];
    double entropy = 0;
    for (int c = 0; c < target.channels; ++c) {
      const float p = half_to_float(t[c]);
      if (p > 0) entropy -= static_cast<double>(p) * std::log(p);
    }
    const double share = most > 0 ? std::min(std::max(1 - entropy / most, 0.0), 1.0) : 1.0;
    const float confidence = target.confidence.empty() ? 1.0f : target.confidence[i];
    out[i] = std::isfinite(share) && confidence > 0 ? static_cast<float>(share) * std::min(confidence, 1.0f) : 0.0f;
  }
  return out;
}

void require_camera_size(const ViewData& data, int width, int height, const char* field) {
  if (width == data.camera.width && height == data.camera.height) return;
  throw_bad_input(data.name, field,
                  "a map of " + std::to_string(width) + " x " + std::to_string(height) + " for a camera of " +
                      std::to_string(data.camera.width) + " x " + std::to_string(data.camera.height),
                  "load the view with load_view, which brings every map to the camera's size");
}

void check_sizes(const ViewData& data, const ImageF* confidence) {
  require_camera_size(data, data.color.width, data.color.height, "color");
  const auto optional = [&](const auto& map, const char* field) {
    if (!map.empty()) require_camera_size(data, map.width, map.height, field);
  };
  optional(data.mask, "mask");
  optional(data.prior_depth, "prior_depth");
  optional(data.labels, "labels");
  if (confidence) optional(*confidence, "prior_confidence");
  const SemanticTarget& t = data.semantics;
  if (t.empty()) return;
  const size_t pixels = static_cast<size_t>(std::max(t.width, 0)) * static_cast<size_t>(std::max(t.height, 0));
  if (t.channels < 1 || pixels == 0 || t.probabilities.size() != pixels * t.channels ||
      (!t.confidence.empty() && t.confidence.size() != pixels)) {
    throw_bad_input(data.name, "semantics", "the number of probabilities does not match the map's size",
                    "give channels x width x height values");
  }
}

}  // namespace

Image<uint8_t> label_edge_map(const Image<uint16_t>& labels, const PrepareOptions& options) {
  if (!options.paper) return label_band(labels, options.label_edge_radius);
  Image<uint8_t> edge(labels.width, labels.height, 1);
  const auto differ = [&](uint16_t a, uint16_t b) { return a != b && a != kNoLabel && b != kNoLabel; };
  for (int y = 0; y < labels.height; ++y) {
    for (int x = 0; x < labels.width; ++x) {
      const uint16_t label = labels.at(x, y);
      edge.at(x, y) = (x + 1 < labels.width && differ(label, labels.at(x + 1, y))) ||
                      (y + 1 < labels.height && differ(label, labels.at(x, y + 1)));
    }
  }
  return edge;
}

ImageF depth_weight_map(const ImageF& depth, const ImageF* confidence, const PrepareOptions& options) {
  ImageF weight(depth.width, depth.height, 1);
  const Image<uint8_t> band = depth_band(depth, options);
  const auto usable = [&](size_t i) {
    return is_depth(depth.data[i]) && (!confidence || confidence->data[i] > 0);  // NaN and 0 know nothing
  };
  float low = 0, high = 0;
  if (confidence) {
    std::vector<float> values;
    for (size_t i = 0; i < depth.data.size(); ++i) {
      if (usable(i)) values.push_back(confidence->data[i]);
    }
    if (values.empty()) return weight;
    low = nearest_rank_of(values, options.confidence_low);
    high = nearest_rank_of(values, options.confidence_high);
  }
  for (size_t i = 0; i < depth.data.size(); ++i) {
    if (!usable(i) || band.data[i]) continue;
    weight.data[i] = 1;
    if (confidence && high > low) {
      weight.data[i] = std::min(std::max((confidence->data[i] - low) / (high - low), 0.0f), 1.0f);
    } else if (confidence) {
      weight.data[i] = confidence->data[i] >= high ? 1.0f : 0.0f;
    }
  }
  return weight;
}

ImageF semantic_weight_map(const ViewData& data, const PrepareOptions& options) {
  const int width = data.camera.width, height = data.camera.height;
  const std::vector<float> source = certainty(data.semantics);
  ImageF weight(width, height, 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const TeacherTaps taps = teacher_taps(data.semantics, x, y, width, height);
      if (!taps.valid) continue;
      float sum = 0;
      for (int k = 0; k < 4; ++k) sum += taps.weight[k] * source[static_cast<size_t>(taps.pixel[k])];
      weight.at(x, y) = std::min(sum, 1.0f);  // the taps carry the scale of the probabilities
    }
  }
  if (data.labels.empty()) return weight;
  const Image<uint8_t> teacher = label_band(data.labels, options.edge_radius);
  const Image<uint8_t> color = color_band(data.color, options);
  const Image<uint8_t> depth = data.prior_depth.empty() ? Image<uint8_t>() : depth_band(data.prior_depth, options);
  for (size_t i = 0; i < weight.data.size(); ++i) {
    const bool supported = color.data[i] || (!depth.empty() && depth.data[i]);
    if (teacher.data[i] && !supported) weight.data[i] = 0;
  }
  return weight;
}

TrainingView prepare_view(ViewData data, const PrepareOptions& options, const ImageF* prior_confidence) {
  check_sizes(data, prior_confidence);
  TrainingView view;
  if (!data.labels.empty()) view.label_edge = label_edge_map(data.labels, options);
  if (!data.prior_depth.empty()) {
    if (options.depth_weights) view.depth_weight = depth_weight_map(data.prior_depth, prior_confidence, options);
    if (options.prior_normals) view.prior_normal = camera_normals(data.prior_depth, data.camera);
  }
  if (!data.semantics.empty() && options.semantic_weights) view.semantic_weight = semantic_weight_map(data, options);
  view.data = std::move(data);
  return view;
}

}  // namespace aligngs
