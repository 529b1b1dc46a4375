// A step of the engine changes parameters by Adam's formula, with the gradients that the engine reports.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/cpu/cpu_engine.h"
#include "engine/formulas/adam.h"
#include "engine/testing/scenes.h"

namespace aligngs::cpu {
namespace {

using namespace testing_scene;

TEST(CpuOptimiser, AdamFollowsTheFormula) {
  const RandomSceneOptions o;
  CpuEngine engine(2);
  engine.keep_features(true);
  const GaussianModel before = make_model(o);
  engine.load(before);
  engine.set_training_views({make_view(o)});
  StepRequest r = make_request();
  engine.step(r);
  const GaussianModel gradient = engine.last_gradients();
  GaussianModel after;
  engine.store(after);
  const auto check = [&](const std::vector<float>& p0, const std::vector<float>& g, const std::vector<float>& p1,
                         double rate) {
    const AdamStep<double> step = make_adam_step<double>(r.adam, rate, 1);
    for (size_t i = 0; i < p0.size(); ++i) {
      double want = p0[i], m = 0, v = 0;
      if (std::abs(g[i]) > 0 && std::abs(g[i]) < 1e-12f) continue;  // comparable to epsilon: rounding decides
      adam_update<double>(step, g[i], want, m, v);
      ASSERT_NEAR(p1[i], want, 1e-5 * rate + 1e-6 * std::abs(want)) << i << " gradient " << g[i];
    }
  };
  check(before.positions, gradient.positions, after.positions, r.rates.position);
  check(before.log_scales, gradient.log_scales, after.log_scales, r.rates.scale);
  check(before.rotations, gradient.rotations, after.rotations, r.rates.rotation);
  check(before.opacity_logits, gradient.opacity_logits, after.opacity_logits, r.rates.opacity);
  check(before.semantics, gradient.semantics, after.semantics, r.rates.semantic);
  std::vector<float> dc[3], rest[3];
  const std::vector<float>* sh[3] = {&before.sh, &gradient.sh, &after.sh};
  for (size_t i = 0; i < before.sh.size(); ++i) {
    for (int k = 0; k < 3; ++k) (i % (3 * kShCoefficients) < 3 ? dc : rest)[k].push_back((*sh[k])[i]);
  }
  check(dc[0], dc[1], dc[2], r.rates.sh_dc);
  check(rest[0], rest[1], rest[2], r.rates.sh_rest);
}

TEST(CpuOptimiser, SemanticRowsAreCorrectedByTheirOwnUpdates) {
  const RandomSceneOptions o;
  CpuEngine engine(2);
  engine.set_semantic_products(SemanticProducts::kFloat32);  // gradients that are not rounded
  engine.keep_features(true);
  const GaussianModel before = make_model(o);
  engine.load(before);
  TrainingView away = make_view(o);
  for (const int axis : {0, 2}) {  // a half turn about the vertical: everything is behind it
    Mat3d& rotation = away.data.camera.world_to_camera.rotation;
    for (int k = 0; k < 3; ++k) rotation(axis, k) = -rotation(axis, k);
  }
  engine.set_training_views({make_view(o), away});
  StepRequest r = make_request();
  r.adam.skip_invisible_semantics = true;
  std::vector<double> want(before.semantics.begin(), before.semantics.end()), m(want.size()), v(want.size());
  std::vector<int> updates(before.size(), 0);
  for (r.step = 1; r.step <= 30; ++r.step) {
    r.view = r.step == 1 || r.step == 30 ? 0 : 1;
    engine.step(r);
    if (r.view == 1) continue;
    const std::vector<float>& gradient = engine.last_gradients().semantics;
    for (size_t i = 0; i < before.size(); ++i) {
      const size_t row = i * static_cast<size_t>(o.channels);
      const bool used = std::any_of(&gradient[row], &gradient[row] + o.channels, [](float g) { return g != 0; });
      if (!used) continue;
      const AdamStep<double> step = make_adam_step<double>(r.adam, r.rates.semantic, ++updates[i]);
      for (size_t c = row; c < row + static_cast<size_t>(o.channels); ++c) {
        adam_update<double>(step, gradient[c], want[c], m[c], v[c]);
      }
    }
  }
  GaussianModel after;
  engine.store(after);
  EXPECT_GT(std::count(updates.begin(), updates.end(), 2), 10);
  for (size_t i = 0; i < want.size(); ++i) {
    ASSERT_NEAR(after.semantics[i], want[i], 1e-3 * r.rates.semantic + 1e-5 * std::abs(want[i])) << i;
  }
}

}  // namespace
}  // namespace aligngs::cpu
