// Scenes whose teacher shows nine of many classes.
#pragma once

#include "engine/testing/scenes.h"

namespace aligngs::cpu::testing_scene {

inline constexpr int kActive = 9;  ///< classes that the teacher shows: 3, 7, 11, ... of many
inline uint16_t active_class(int i, int channels) { return static_cast<uint16_t>(channels < 40 ? i : 3 + 4 * i); }

/// A teacher that mixes two active classes in smooth regions. The rest of its mass lies on the inactive classes, evenly
/// or (`uneven`) at random.
inline TrainingView teacher_view(const RandomSceneOptions& o, bool uneven, double rest = 0.1) {
  Random random(o.seed + 7);
  TrainingView v = make_view(o);
  SemanticTarget& t = v.data.semantics;
  const size_t channels = static_cast<size_t>(o.channels);
  for (int i = 0; i < t.width * t.height; ++i) {
    const int region = (i % t.width) * 3 / t.width + 3 * ((i / t.width) * 3 / t.height);
    const uint16_t first = active_class(region, o.channels), second = active_class((region + 1) % kActive, o.channels);
    const double share = random.uniform(0.6, 0.9);
    std::vector<double> p(channels);
    double sum = 0;
    for (double& x : p) sum += x = uneven ? random.uniform(0.0, 1.0) : 1.0;
    for (int k = 0; k < kActive; ++k) {
      sum -= p[active_class(k, o.channels)];
      p[active_class(k, o.channels)] = 0;
    }
    for (double& x : p) x *= rest / sum;
    p[first] += (1 - rest) * share;
    p[second] += (1 - rest) * (1 - share);
    for (size_t c = 0; c < channels; ++c) t.probabilities[i * channels + c] = float_to_half(static_cast<float>(p[c]));
  }
  return v;
}

inline std::vector<uint8_t> active_flags(int channels) {
  std::vector<uint8_t> active(static_cast<size_t>(channels), 0);
  for (int k = 0; k < kActive; ++k) active[active_class(k, channels)] = 1;
  return active;
}

/// A model whose rows hold one number for all inactive classes.
inline GaussianModel model_with_remainder(const RandomSceneOptions& o) {
  GaussianModel m = make_model(o);
  for (size_t i = 0; i < m.size(); ++i) {
    float* row = &m.semantics[i * static_cast<size_t>(o.channels)];
    const float rest = row[0];
    const std::vector<uint8_t> active = active_flags(o.channels);
    for (int c = 0; c < o.channels; ++c) row[c] = active[static_cast<size_t>(c)] != 0 ? row[c] : rest;
  }
  return m;
}

inline RandomSceneOptions options(int channels) {
  RandomSceneOptions o;
  o.channels = channels;
  o.gaussians = 200;
  return o;
}

/// The views come after the model.
inline void prepare(CpuEngine& engine, int top_k, const GaussianModel& model, const TrainingView& view,
                    SemanticProducts products = SemanticProducts::kFloat32) {
  engine.set_semantic_products(products);
  engine.prepare({{}, top_k, &model});
  engine.set_training_views({view});
  engine.set_coupling_balance({2e-4, 1e-3});
}

}  // namespace aligngs::cpu::testing_scene
