// Random and adversarial scenes on which the engine is compared with the reference.
#pragma once

#include <cmath>
#include <string>

#include "core/half.h"
#include "core/random.h"
#include "engine/cpu/cpu_engine.h"
#include "engine/reference/reference_engine.h"
#include "engine/testing/request.h"
#include "scene/semantic_target.h"

namespace aligngs::cpu::testing_scene {

/// A scene of Gaussians in front of a camera at the origin of a tilted frame.
struct RandomSceneOptions {
  int width = 53, height = 37;  ///< no multiples of the tile
  size_t gaussians = 300;
  int channels = 7;
  double depth_min = 1, depth_max = 4;
  double log_scale_min = -4, log_scale_max = -1.5;
  double logit_min = -2, logit_max = 3;
  uint64_t seed = 1;
};

inline Camera make_camera(int width, int height) {
  Camera c;
  c.width = width;
  c.height = height;
  c.fx = 0.9 * std::max(width, 8);
  c.fy = 0.95 * std::max(width, 8);
  c.cx = 0.53 * width;
  c.cy = 0.46 * height;
  c.world_to_camera.rotation = rotation_matrix(normalized(Quaterniond{0.97, 0.1, -0.15, 0.08}));
  c.world_to_camera.translation = {0.1, -0.2, 0.3};
  return c;
}

inline GaussianModel make_model(const RandomSceneOptions& o) {
  Random random(o.seed);
  const Camera camera = make_camera(o.width, o.height);
  const Rigidd to_world = camera.world_to_camera.inverse();
  GaussianModel m;
  m.semantic_channels = o.channels;
  m.sh_degree = 3;
  m.resize(o.gaussians);
  for (size_t i = 0; i < o.gaussians; ++i) {
    // A tenth of the image beyond its edges, so that some are cut off and some are outside.
    const double u = random.uniform(-0.1, 1.1) * o.width, v = random.uniform(-0.1, 1.1) * o.height;
    const double z = random.uniform(o.depth_min, o.depth_max);
    const Vec3d p = to_world * (camera.ray(u, v) * z);
    for (int k = 0; k < 3; ++k) m.positions[3 * i + k] = static_cast<float>(p[k]);
    for (int k = 0; k < 3; ++k) {
      m.log_scales[3 * i + k] = static_cast<float>(random.uniform(o.log_scale_min, o.log_scale_max));
    }
    for (int k = 0; k < 4; ++k) m.rotations[4 * i + k] = static_cast<float>(random.normal());
    m.opacity_logits[i] = static_cast<float>(random.uniform(o.logit_min, o.logit_max));
    for (int k = 0; k < 3 * kShCoefficients; ++k) {
      m.sh[3 * kShCoefficients * i + k] = static_cast<float>((k < 3 ? 0.6 : 0.1) * random.normal());
    }
    for (int c = 0; c < o.channels; ++c) m.semantics[o.channels * i + c] = static_cast<float>(random.normal());
  }
  return m;
}

/// A photo of noise over waves, a prior depth with a hole, and a teacher at about half size that is silent in a corner.
inline TrainingView make_view(const RandomSceneOptions& o) {
  Random random(o.seed + 100);
  TrainingView v;
  v.data.name = "view";
  v.data.camera = make_camera(o.width, o.height);
  v.data.color = ImageF(o.width, o.height, 3);
  v.data.prior_depth = ImageF(o.width, o.height, 1);
  v.semantic_weight = ImageF(o.width, o.height, 1);
  v.prior_normal = ImageF(o.width, o.height, 3);
  for (int y = 0; y < o.height; ++y) {
    for (int x = 0; x < o.width; ++x) {
      for (int c = 0; c < 3; ++c) {
        v.data.color.at(x, y, c) =
            static_cast<float>(0.5 + 0.3 * std::sin(0.3 * x + 0.2 * y + 2 * c) + random.uniform(-0.1, 0.1));
      }
      v.data.prior_depth.at(x, y) =
          x < o.width / 6 ? 0.0f : static_cast<float>(2.2 + 0.3 * std::sin(0.1 * x + 0.2 * y));
      v.semantic_weight.at(x, y) = static_cast<float>(random.uniform(0.2, 1.0));
      v.prior_normal.at(x, y, 2) = -1.0f;
    }
  }
  if (o.channels > 0) {
    SemanticTarget& t = v.data.semantics;
    t.channels = o.channels;
    t.width = (o.width + 1) / 2;
    t.height = (o.height + 1) / 2;
    std::vector<double> p(o.channels);
    for (int i = 0; i < t.width * t.height; ++i) {
      double sum = 0;
      for (double& x : p) sum += x = std::exp(2 * random.normal());
      for (const double x : p) t.probabilities.push_back(float_to_half(static_cast<float>(x / sum)));
      t.confidence.push_back(i < t.width / 3 ? 0.0f : 0.8f);
    }
    normalise_target(t);
  }
  return v;
}

/// Photometric and semantic losses; rates of the usual size.
inline StepRequest make_request() {
  StepRequest r = color_and_class_request();
  r.sh_degree = 3;
  r.extent = 2.5f;
  r.raster.background[0] = 0.3f;
  r.raster.background[1] = 0.1f;
  r.raster.background[2] = 0.6f;
  r.losses.weight[Loss::kFlatten] = 10;
  r.losses.weight[Loss::kOpacityL1] = 0.01f;
  r.losses.weight[Loss::kScaleL1] = 0.01f;
  r.rates = {1e-3f, 2.5e-3f, 1e-4f, 2e-2f, 5e-3f, 1e-3f, 5e-3f};
  return r;
}

/// The same with every geometry loss.
inline StepRequest make_geometry_request() {
  StepRequest r = make_request();
  r.losses.weight[Loss::kLogDepth] = 0.5f;
  r.losses.weight[Loss::kNormalConsistency] = 0.05f;
  r.losses.weight[Loss::kPriorNormal] = 0.05f;
  return r;
}

inline GaussianModelT<double> to_double(const GaussianModel& m) {
  GaussianModelT<double> d;
  d.semantic_channels = m.semantic_channels;
  d.sh_degree = m.sh_degree;
  const auto copy = [](const std::vector<float>& from, std::vector<double>& to) {
    to.assign(from.begin(), from.end());
  };
  copy(m.positions, d.positions);
  copy(m.log_scales, d.log_scales);
  copy(m.rotations, d.rotations);
  copy(m.opacity_logits, d.opacity_logits);
  copy(m.sh, d.sh);
  copy(m.semantics, d.semantics);
  return d;
}

/// Largest |a - b| over the largest |b|, and where.
struct Difference {
  double worst = 0, scale = 0;
  size_t at = 0;
};
template <class A, class B>
Difference difference(const A& a, const B& b) {
  Difference d;
  if (a.size() != b.size()) return {1e30, 1e30, 0};
  double worst = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    const double x = static_cast<double>(a[i]), y = static_cast<double>(b[i]);
    d.scale = std::max(d.scale, std::abs(y));
    if (!(std::abs(x - y) <= worst)) {
      worst = std::abs(x - y);
      d.at = i;
    }
  }
  d.worst = d.scale > 0 ? worst / d.scale : worst;
  return d;
}

}  // namespace aligngs::cpu::testing_scene
