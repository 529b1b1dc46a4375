// For tests: a few steps of an engine on two views, and what state they leave.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "engine/engine.h"
#include "engine/testing/scenes.h"

namespace aligngs::cpu::testing_scene {

inline std::vector<TrainingView> two_views(const RandomSceneOptions& o) {
  TrainingView first = make_view(o), second = make_view(o);
  second.data.camera.world_to_camera.translation.x += 0.3;
  return {first, second};
}

/// Steps [first, last] alternate between the views.
inline void run_steps(Engine& engine, int first, int last) {
  StepRequest r = make_geometry_request();
  for (r.step = first; r.step <= last; ++r.step) {
    r.view = static_cast<int>(r.step % 2);
    ASSERT_FALSE(engine.step(r).non_finite.found);
  }
}

inline bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0);
}

inline void expect_same_state(const EngineState& a, const EngineState& b) {
  EXPECT_TRUE(same_bits(a.model.positions, b.model.positions));
  EXPECT_TRUE(same_bits(a.model.log_scales, b.model.log_scales));
  EXPECT_TRUE(same_bits(a.model.rotations, b.model.rotations));
  EXPECT_TRUE(same_bits(a.model.opacity_logits, b.model.opacity_logits));
  EXPECT_TRUE(same_bits(a.model.sh, b.model.sh));
  EXPECT_TRUE(same_bits(a.model.semantics, b.model.semantics));
  ASSERT_EQ(a.arrays.size(), b.arrays.size());
  for (const auto& [name, values] : a.arrays) EXPECT_TRUE(same_bits(values, b.arrays.at(name))) << name;
}

inline EngineState state_of(const Engine& engine) {
  EngineState s;
  engine.save_state(s);
  return s;
}

}  // namespace aligngs::cpu::testing_scene
