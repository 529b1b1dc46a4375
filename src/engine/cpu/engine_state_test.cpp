// Changes of an engine's parameters between steps.
#include <gtest/gtest.h>

#include <limits>

#include "core/error.h"
#include "engine/cpu/cpu_engine.h"
#include "engine/cpu/testing/engine_runs.h"
#include "engine/engine_arrays.h"
#include "engine/formulas/shape_terms.h"

namespace aligngs::cpu {
namespace {

using namespace testing_scene;

TEST(CpuEngine, NoiseMovesPositionsAloneAndAlikeOnAnyNumberOfThreads) {
  const RandomSceneOptions o;
  GaussianModel model = make_model(o);
  for (size_t i = 0; i < model.size(); i += 2) model.opacity_logits[i] = -6;
  CpuEngine one(1), three(3);
  for (CpuEngine* engine : {&one, &three}) {
    engine->load(model);
    engine->add_position_noise({10, 5});
  }
  const EngineState a = state_of(one), b = state_of(three);
  EXPECT_EQ(a.model.positions, b.model.positions);
  EXPECT_NE(a.model.positions, model.positions);
  EXPECT_EQ(a.model.log_scales, model.log_scales);
  one.load(model);
  one.add_position_noise({});
  EXPECT_EQ(state_of(one).model.positions, model.positions);
}

TEST(CpuEngine, MomentsAreZerosBeforeTheFirstStepAlsoWhereNoneAreHeld) {
  const RandomSceneOptions o;
  CpuEngine loaded(1), resumed(1);
  loaded.load(make_model(o));
  const EngineState state = state_of(loaded);
  const EngineMemory memory = unpack_state(state);
  EXPECT_EQ(memory.moments.m.size(), loaded.size());
  for (const float m : memory.moments.v.sh) ASSERT_EQ(m, 0);
  resumed.load_state(state);  // this one holds its zeros
  for (CpuEngine* engine : {&loaded, &resumed}) {
    engine->set_training_views(two_views(o));
    engine->reset_opacity(0.5f);
    run_steps(*engine, 1, 2);
  }
  expect_same_state(state_of(loaded), state_of(resumed));
}

TEST(CpuEngine, ScalesAreRaisedAndMomentsKept) {
  const RandomSceneOptions o;
  CpuEngine engine(1);
  engine.load(make_model(o));
  engine.set_training_views(two_views(o));
  run_steps(engine, 1, 2);
  const EngineState before = state_of(engine);
  std::vector<float> floors(before.model.size(), -2.0f);
  floors[0] = -std::numeric_limits<float>::infinity();
  engine.raise_scales(floors);
  const EngineState after = state_of(engine);
  EXPECT_EQ(after.arrays, before.arrays);
  for (size_t i = 0; i < before.model.size(); ++i) {
    Vec3<float> want{before.model.log_scales[3 * i], before.model.log_scales[3 * i + 1],
                     before.model.log_scales[3 * i + 2]};
    raise_larger_scales(floors[i], want);
    for (int k = 0; k < 3; ++k) EXPECT_EQ(after.model.log_scales[3 * i + static_cast<size_t>(k)], want[k]);
  }
  floors.pop_back();
  EXPECT_THROW(engine.raise_scales(floors), Error);
}

}  // namespace
}  // namespace aligngs::cpu
