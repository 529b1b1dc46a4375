// A small hand-placed scene and finite differences over every parameter, shared by the gradient tests.
#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "core/half.h"
#include "engine/reference/reference_engine.h"
#include "engine/testing/request.h"
#include "scene/semantic_target.h"

namespace aligngs::reference::testing_scene {

inline constexpr int kWidth = 16, kHeight = 12, kChannels = 5;

/// An off-centre principal point and a tilted pose, so that no symmetry hides a sign.
inline Camera make_camera() {
  Camera c;
  c.width = kWidth;
  c.height = kHeight;
  c.fx = 14;
  c.fy = 13;
  c.cx = 8.7;
  c.cy = 5.4;
  c.world_to_camera.rotation = rotation_matrix(normalized(Quaterniond{0.97, 0.1, -0.15, 0.08}));
  c.world_to_camera.translation = {0.1, -0.2, 0.3};
  return c;
}

/// Eight Gaussians between 1.5 and 4 in front of the camera, overlapping, flat, long and round. Row 6 lies outside the
/// guard band (its Jacobian is clamped) but reaches into the image.
template <class T>
GaussianModelT<T> make_model() {
  struct Row {
    double position[3], log_scale[3], rotation[4], logit;  // position in the camera frame
  };
  const Row rows[] = {
      {{-0.45, 0.20, 1.6}, {-1.9, -1.5, -2.6}, {0.9, 0.2, -0.3, 0.1}, 0.8},
      {{0.30, -0.35, 1.9}, {-1.2, -2.7, -1.7}, {1.3, -0.4, 0.5, 0.3}, -0.3},
      {{-0.20, -0.30, 2.2}, {-2.4, -1.1, -1.4}, {0.4, 0.7, 0.1, -0.5}, 1.7},
      {{0.55, 0.40, 2.5}, {-0.9, -1.3, -3.0}, {-0.8, 0.1, 0.4, 0.2}, 0.2},
      {{0.05, 0.10, 2.8}, {-0.8, -0.7, -1.6}, {0.6, -0.2, 0.3, 0.9}, 1.1},
      {{-0.90, 0.55, 3.1}, {-0.5, -1.4, -1.0}, {1.0, 0.5, -0.2, 0.4}, 0.5},
      {{2.10, 0.30, 2.3}, {-0.1, -0.9, -1.3}, {0.7, 0.3, 0.6, -0.1}, 0.9},
      {{0.20, -0.10, 3.9}, {0.3, 0.2, -1.5}, {0.9, 0.05, -0.1, 0.2}, 2.0},
  };
  const Rigidd to_world = make_camera().world_to_camera.inverse();
  GaussianModelT<T> m;
  m.semantic_channels = kChannels;
  m.sh_degree = 3;
  m.resize(8);
  for (size_t i = 0; i < 8; ++i) {
    const Vec3d p = to_world * Vec3d{rows[i].position[0], rows[i].position[1], rows[i].position[2]};
    for (int k = 0; k < 3; ++k) m.positions[3 * i + k] = T(p[k]);
    for (int k = 0; k < 3; ++k) m.log_scales[3 * i + k] = T(rows[i].log_scale[k]);
    for (int k = 0; k < 4; ++k) m.rotations[4 * i + k] = T(rows[i].rotation[k]);
    m.opacity_logits[i] = T(rows[i].logit);
    for (int k = 0; k < 3 * kShCoefficients; ++k) {
      // Irregular numbers of a sensible size: about +-0.6 for the constant term, +-0.1 for the others.
      m.sh[3 * kShCoefficients * i + k] = T((k < 3 ? 0.6 : 0.1) * std::sin(1.7 * k + 2.9 * i + 0.4));
    }
    for (int c = 0; c < kChannels; ++c) m.semantics[kChannels * i + c] = T(1.3 * std::sin(2.3 * c + 1.1 * i + 0.7));
  }
  m.sh[2] = T(-3);  // row 0, blue: clamped at 0, no gradient
  return m;
}

/// A view with a colour image, a prior depth with a hole, and a teacher at half size with a corner that says nothing.
inline TrainingView make_view() {
  TrainingView v;
  v.data.name = "view";
  v.data.camera = make_camera();
  v.data.color = ImageF(kWidth, kHeight, 3);
  v.data.prior_depth = ImageF(kWidth, kHeight, 1);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (int c = 0; c < 3; ++c) v.data.color.at(x, y, c) = float(0.5 + 0.4 * std::sin(0.7 * x + 1.1 * y + 2.0 * c));
      v.data.prior_depth.at(x, y) = x < 3 ? 0.0f : 2.5f + 0.1f * y;
    }
  }
  SemanticTarget& t = v.data.semantics;
  t.channels = kChannels;
  t.width = kWidth / 2;
  t.height = kHeight / 2;
  for (int y = 0; y < t.height; ++y) {
    for (int x = 0; x < t.width; ++x) {
      double p[kChannels], sum = 0;
      for (int c = 0; c < kChannels; ++c) sum += p[c] = std::exp(1.5 * std::sin(1.9 * c + 0.8 * x - 1.3 * y));
      for (int c = 0; c < kChannels; ++c) t.probabilities.push_back(float_to_half(float(p[c] / sum)));
      t.confidence.push_back(x < 2 && y < 2 ? 0.0f : 0.8f);
    }
  }
  normalise_target(t);
  return v;
}

/// All losses off, tests switch on what they look at. The threshold is smooth, so that differences hold.
inline StepRequest make_request() {
  StepRequest r = color_and_class_request();
  r.sh_degree = 3;
  r.extent = 2.5f;
  r.raster.smooth_cutoff = true;
  r.raster.background[0] = 0.3f;
  r.raster.background[1] = 0.1f;
  r.raster.background[2] = 0.6f;
  r.losses.weight[Loss::kFlatten] = 0;
  r.losses.weight[Loss::kSemanticSoft] = 0;
  r.losses.weight[Loss::kSemanticHard] = 0;
  return r;
}

inline const MapLossFunction<double>& no_map_loss() {
  static const MapLossFunction<double> none = [](const RenderMaps<double>&, LossTerms&, MapGradients<double>&) {};
  return none;
}

using Model = GaussianModelT<double>;

/// The arrays of a model by name; "sh_dc" and "sh_rest" are parts of one array.
struct ParameterClass {
  const char* name;
  std::vector<double> Model::*values;
  int row, begin, end;  ///< entries [begin, end) of every `row`
};
inline const std::vector<ParameterClass>& parameter_classes() {
  static const std::vector<ParameterClass> classes = {{"position", &Model::positions, 3, 0, 3},
                                                      {"log_scale", &Model::log_scales, 3, 0, 3},
                                                      {"rotation", &Model::rotations, 4, 0, 4},
                                                      {"opacity", &Model::opacity_logits, 1, 0, 1},
                                                      {"sh_dc", &Model::sh, 3 * kShCoefficients, 0, 3},
                                                      {"sh_rest", &Model::sh, 3 * kShCoefficients, 3, 48},
                                                      {"semantics", &Model::semantics, kChannels, 0, kChannels}};
  return classes;
}

/// The comparison of a gradient with differences, for one class of parameters.
struct Comparison {
  double worst = 0;    ///< largest |analytic - numeric| / (scale of the class's gradient)
  double largest = 0;  ///< largest |numeric|: 0 means that the test would see nothing
  std::string where;
};

/// Central differences of `loss` with step h, over every entry of the class. Errors are relative to the largest
/// entry of the class (differences of 1e-5 steps leave about 1e-9 of rounding).
inline Comparison compare(const ParameterClass& c, const Model& model, const Model& gradient,
                          const std::function<double(const Model&)>& loss, double h = 1e-5) {
  Comparison out;
  Model moved = model;
  std::vector<double>& values = moved.*c.values;
  const std::vector<double>& analytic = gradient.*c.values;
  double worst = 0;
  for (size_t k = 0; k < values.size(); ++k) {
    const int column = static_cast<int>(k % c.row);
    if (column < c.begin || column >= c.end) continue;
    const double start = values[k];
    values[k] = start + h;
    const double up = loss(moved);
    values[k] = start - h;
    const double down = loss(moved);
    values[k] = start;
    const double numeric = (up - down) / (2 * h), error = std::abs(numeric - analytic[k]);
    out.largest = std::max(out.largest, std::abs(numeric));
    if (!(error <= worst)) {
      worst = error;
      out.where = std::string(c.name) + "[" + std::to_string(k) + "]: analytic " + std::to_string(analytic[k]) +
                  ", numeric " + std::to_string(numeric);
    }
  }
  out.worst = out.largest > 0 ? worst / out.largest : worst;
  return out;
}

}  // namespace aligngs::reference::testing_scene
