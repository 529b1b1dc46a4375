// Tests that run once for every way to form the semantic products.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "engine/cpu/cpu_engine.h"
#include "engine/cpu/matrix_tiles.h"

namespace aligngs::cpu::testing_scene {

/// GetParam() is the implementation; where the machine lacks it, the test is skipped with a message.
class ProductsTest : public testing::TestWithParam<SemanticProducts> {
 protected:
  void SetUp() override {
    if (GetParam() == SemanticProducts::kBfloat16 && !matrix_tiles_available()) {
      GTEST_SKIP() << "bfloat16 products need AMX, which this machine lacks";
    }
  }
  static bool exact() { return GetParam() == SemanticProducts::kFloat32; }
};

inline auto every_products() { return testing::Values(SemanticProducts::kFloat32, SemanticProducts::kBfloat16); }
inline std::string products_name(const testing::TestParamInfo<SemanticProducts>& info) {
  return info.param == SemanticProducts::kFloat32 ? "Float32" : "Bfloat16";
}

}  // namespace aligngs::cpu::testing_scene
