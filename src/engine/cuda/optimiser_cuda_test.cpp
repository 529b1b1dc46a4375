// Adam, the limits on shape and the search for bad parameters against the CPU engine's.
#include "engine/cuda/optimiser.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/random.h"
#include "device/testing/device.h"
#include "device/tolerances.h"
#include "engine/cpu/optimiser.h"
#include "engine/cuda/model_arrays.h"
#include "engine/cuda/semantic_rows.h"
#include "engine/testing/request.h"

namespace aligngs::cuda {
namespace {

class CudaOptimiser : public DeviceTest {
 protected:
  static constexpr size_t kRows = 300;  // more than one block
  static constexpr int kChannels = 7;

  CudaOptimiser() {
    Random random(4);
    const auto fill = [&](std::vector<float>& values, double low, double high) {
      for (float& v : values) v = static_cast<float>(random.uniform(low, high));
    };
    const auto fill_model = [&](GaussianModel& m, double low, double high) {
      m.semantic_channels = kChannels;
      m.resize(kRows);
      for (auto* values : {&m.positions, &m.log_scales, &m.rotations, &m.opacity_logits, &m.sh, &m.semantics}) {
        fill(*values, low, high);
      }
    };
    fill_model(model, -1, 1);
    fill_model(moments.m, -0.01, 0.01);
    fill_model(moments.v, 0, 1e-4);
    fill_model(gradients, -0.1, 0.1);
    // of 16 steps before
    for (size_t i = 0; i < kRows; ++i) moments.semantic_updates.push_back(static_cast<float>(i % 17));
    moments.sh_used = 12;
    for (GaussianModel* m : {&moments.m, &moments.v}) {
      for (size_t i = 0; i < m->sh.size(); ++i) {
        if (i % 48 >= 12) m->sh[i] = 0;
      }
    }
    for (size_t i = 0; i < gradients.sh.size(); ++i) {
      if (i % 48 >= 12) gradients.sh[i] = 0;
    }
    request.step = 17;
    request.sh_degree = 1;
    request.rates = {0.011f, 0.012f, 0.003f, 0.05f, 0.02f, 0.007f, 0.04f};
    for (size_t i = 0; i < kRows; ++i) {
      touched.push_back(random.chance(0.7) ? 1 : 0);
      culled.push_back(touched[i] == 0 && random.chance(0.5) ? 1 : 0);
      written.push_back(touched[i] != 0 && random.chance(0.8) ? 1 : 0);
    }
  }

  void run_cpu() {
    cpu::ParameterGradients g;
    const auto copy = [](const std::vector<float>& from, AlignedFloats& to) {
      to.resize(from.size());
      std::copy(from.begin(), from.end(), to.data());
    };
    copy(gradients.positions, g.positions);
    copy(gradients.log_scales, g.log_scales);
    copy(gradients.rotations, g.rotations);
    copy(gradients.opacity_logits, g.opacity_logits);
    copy(gradients.sh, g.sh);
    g.touched = touched;
    cpu::ProjectedView view;
    view.rects.resize(kRows);
    std::vector<uint32_t> rank;
    std::vector<uint8_t> ranked;
    AlignedFloats rows;
    rows.resize(kRows * kCpuPadded);
    std::fill_n(rows.data(), rows.size(), 0.0f);
    for (size_t i = 0; i < kRows; ++i) {
      rank.push_back(static_cast<uint32_t>(ranked.size()));
      if (culled[i] != 0) continue;
      view.rects[i] = {0, 0, 1, 1};
      for (int c = 0; c < kChannels; ++c) {
        rows[ranked.size() * kCpuPadded + static_cast<size_t>(c)] = gradients.semantics[i * kChannels + size_t(c)];
      }
      ranked.push_back(written[i]);
    }
    cpu::SemanticGradients semantic;
    if (semantics) semantic = {rank.data(), ranked.data(), rows.data(), false, nullptr, 0};
    ThreadPool pool(1);
    cpu::optimise(request, g, semantic, view, pool, cpu_model = model, cpu_moments = moments);
  }

  void run_device() {
    ModelArrays p, m, v, g;
    p.upload(context(), model, "test");
    m.upload(context(), moments.m, "test");
    v.upload(context(), moments.v, "test");
    GaussianModel poisoned = gradients;  // rows that are not touched are not read
    for (size_t i = 0; i < kRows; ++i) {
      if (touched[i] == 0) std::fill_n(&poisoned.sh[48 * i], 48, std::numeric_limits<float>::quiet_NaN());
    }
    g.upload(context(), poisoned, "test");
    std::vector<uint32_t> rank;
    std::vector<float> rows;
    for (size_t i = 0; i < kRows; ++i) {
      rank.push_back(static_cast<uint32_t>(rows.size()) / kPadded);
      if (culled[i] != 0) continue;
      for (int c = 0; c < kPadded; ++c) {
        rows.push_back(c < kChannels && written[i] != 0 ? gradients.semantics[i * kChannels + size_t(c)]
                                                        : std::numeric_limits<float>::quiet_NaN());
      }
    }
    DeviceArray<uint8_t> touched_rows, written_rows;
    DeviceArray<uint32_t> ranks, block;
    DeviceArray<float> semantic_rows;
    touched_rows.assign(context(), touched, "test");
    written_rows.assign(context(), written, "test");
    ranks.assign(context(), rank, "test");
    semantic_rows.assign(context(), rows, "test");
    block.assign(context(), {blocked ? 1u : 0u}, "test");
    OptimiserInputs in;
    in.gradients = g.spans();
    in.touched = touched_rows.span();
    if (semantics) {
      in.semantic_gradients = semantic_rows.span();
      in.semantic_written = written_rows.span();
      in.rank = ranks.span();
    }
    in.blocked = block.span();
    DeviceArray<float> updates;
    updates.assign(context(), moments.semantic_updates, "test");
    optimise(context(), request, in, {p.spans(), m.spans(), v.spans(), updates.span()}, moments.sh_used);
    device_moments.semantic_updates = updates.to_host();
    p.download(device_model);
    m.download(device_moments.m);
    v.download(device_moments.v);
  }

  static void expect_close(const GaussianModel& a, const GaussianModel& b, const char* what) {
    const std::pair<const char*, std::vector<float> GaussianModel::*> classes[] = {
        {"positions", &GaussianModel::positions},
        {"log_scales", &GaussianModel::log_scales},
        {"rotations", &GaussianModel::rotations},
        {"opacity_logits", &GaussianModel::opacity_logits},
        {"sh", &GaussianModel::sh},
        {"semantics", &GaussianModel::semantics}};
    for (const auto& [name, values] : classes) {
      ASSERT_EQ((a.*values).size(), (b.*values).size()) << what << " " << name;
      double worst = 0;
      for (size_t i = 0; i < (a.*values).size(); ++i) {
        const double error = std::abs(double((a.*values)[i]) - (b.*values)[i]);
        worst = std::max(worst, std::isnan(error) ? 1e300 : error);
      }
      EXPECT_LE(worst, CudaTolerance().parameter) << what << " " << name;
    }
  }

  void compare() {
    run_cpu();
    run_device();
    expect_close(device_model, cpu_model, "parameters");
    expect_close(device_moments.m, cpu_moments.m, "first moments");
    expect_close(device_moments.v, cpu_moments.v, "second moments");
    EXPECT_EQ(device_moments.semantic_updates, cpu_moments.semantic_updates);
  }

  using AlignedFloats = decltype(cpu::ParameterGradients::positions);
  static constexpr int kPadded = 16;
  static constexpr size_t kCpuPadded = 16;
  GaussianModel model, gradients, cpu_model, device_model;
  AdamMoments moments, cpu_moments, device_moments;
  StepRequest request = color_and_class_request();
  std::vector<uint8_t> touched, culled, written;
  bool semantics = true, blocked = false;
};

TEST_F(CudaOptimiser, AgreesWithTheCpu) {
  ASSERT_EQ(padded_channels(kChannels), kPadded);
  compare();
}

TEST_F(CudaOptimiser, RowsOutOfSightDecayWhenAsked) {
  request.adam.skip_invisible_semantics = false;
  compare();
}

TEST_F(CudaOptimiser, AStepWithoutSemantics) {
  semantics = false;
  compare();
  EXPECT_EQ(device_model.semantics, model.semantics);
}

TEST_F(CudaOptimiser, LimitsOnShape) {
  request.limits = {0.3f, 1.5f, 2.0f};
  compare();
}

TEST_F(CudaOptimiser, EveryDegreeOfColour) {
  for (const int degree : {0, 2, 3}) {
    request.sh_degree = degree;
    moments.sh_used = size_t(3) * static_cast<size_t>((degree + 1) * (degree + 1));
    Random random(2);
    for (size_t i = 0; i < gradients.sh.size(); ++i) {
      const bool used = i % 48 < moments.sh_used;
      gradients.sh[i] = used ? static_cast<float>(random.uniform(-0.1, 0.1)) : 0.0f;
      if (!used) moments.m.sh[i] = moments.v.sh[i] = 0;
    }
    compare();
  }
}

TEST_F(CudaOptimiser, ABlockedStepWritesNothing) {
  blocked = true;
  request.limits = {0.3f, 1.5f, 2.0f};
  run_device();
  EXPECT_EQ(device_model.positions, model.positions);
  EXPECT_EQ(device_model.log_scales, model.log_scales);
  EXPECT_EQ(device_model.sh, model.sh);
  EXPECT_EQ(device_model.semantics, model.semantics);
  EXPECT_EQ(device_moments.m.positions, moments.m.positions);
  EXPECT_EQ(device_moments.v.sh, moments.v.sh);
}

TEST_F(CudaOptimiser, OpacitiesAreCapped) {
  ModelArrays p, m, v;
  p.upload(context(), model, "test");
  m.upload(context(), moments.m, "test");
  v.upload(context(), moments.v, "test");
  cap_opacities(context(), 0.4f, {p.spans(), m.spans(), v.spans(), {}});
  p.download(device_model);
  m.download(device_moments.m);
  v.download(device_moments.v);
  const float logit = std::log(0.4f / 0.6f);
  for (size_t i = 0; i < kRows; ++i) {
    ASSERT_FLOAT_EQ(device_model.opacity_logits[i], std::min(model.opacity_logits[i], logit));
    ASSERT_EQ(device_moments.m.opacity_logits[i], 0);
    ASSERT_EQ(device_moments.v.opacity_logits[i], 0);
  }
  EXPECT_EQ(device_model.positions, model.positions);
}

TEST_F(CudaOptimiser, TheFirstBadParameterIsFound) {
  DeviceArena arena(context());
  ModelArrays p;
  p.upload(context(), model, "test");
  EXPECT_FALSE(find_bad_parameter(arena, p.spans()).found);
  model.sh[48 * 20 + 7] = std::numeric_limits<float>::quiet_NaN();
  model.rotations[4 * 250] = std::numeric_limits<float>::infinity();
  model.rotations[4 * 211 + 3] = -std::numeric_limits<float>::infinity();
  p.upload(context(), model, "test");
  const NonFinite bad = find_bad_parameter(arena, p.spans());
  EXPECT_TRUE(bad.found);
  EXPECT_EQ(bad.term, "rotations");
  EXPECT_EQ(bad.gaussian, 211);
}

TEST_F(CudaOptimiser, AModelWithoutRows) {
  ModelArrays none;
  none.upload(context(), GaussianModel(), "test");
  DeviceArena arena(context());
  optimise(context(), request, {none.spans(), {}, {}, {}, {}, {}}, {none.spans(), none.spans(), none.spans(), {}}, 3);
  EXPECT_FALSE(find_bad_parameter(arena, none.spans()).found);
}

}  // namespace
}  // namespace aligngs::cuda
