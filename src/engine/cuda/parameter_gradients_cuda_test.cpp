// Reduction of slots and the way back to the parameters against the CPU engine, from the same slots.
#include "engine/cuda/parameter_gradients.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/random.h"
#include "device/tolerances.h"
#include "engine/cuda/testing/view.h"
#include "engine/testing/request.h"

namespace aligngs::cuda {
namespace {

using cpu::testing_scene::difference;
using cpu::testing_scene::make_camera;
using cpu::testing_scene::make_model;
using cpu::testing_scene::make_request;
using cpu::testing_scene::RandomSceneOptions;

const CudaTolerance kParameterTolerance;

class CudaParameterGradients : public DeviceTest {
 protected:
  void prepare(const RandomSceneOptions& scene) {
    options = scene;
    prepare(make_model(scene));
  }

  void prepare(const GaussianModel& gaussians) {
    model = gaussians;
    request = make_request();
    request.losses.weight[Loss::kFlatten] = request.losses.weight[Loss::kOpacityL1] =
        request.losses.weight[Loss::kScaleL1] = 0;
    view = std::make_unique<TestView>(context(), model, make_camera(options.width, options.height), request.raster);
    Random random(9);
    const size_t n = view->lists.instances();
    slots.resize(n);
    for (size_t i = 0; i < n; ++i) {
      float* field = reinterpret_cast<float*>(&slots[i]);
      for (size_t k = 0; k < cpu::kCoupledSplatGradientFloats; ++k) field[k] = float(random.uniform(-1, 1));
    }
    coupling_seen.assign(n, 0);
    for (uint8_t& s : coupling_seen) s = random.chance(0.6) ? 1 : 0;
    for (size_t i = 0; i < n; ++i) {
      if (coupling_seen[i] == 0) std::fill_n(&slots[i].coupling_p, 6, 0.0f);
    }
  }

  void run_device(float coupling_scale) {
    const size_t n = model.size(), instances = view->lists.instances();
    std::vector<SplatGradient> main(instances);
    std::vector<CouplingMoments> moments(instances);
    for (size_t i = 0; i < instances; ++i) {
      const cpu::CoupledSplatGradient& s = slots[i];
      main[i] = s.maps;
      moments[i] = {s.coupling_p, s.coupling_r, s.coupling_one, s.coupling_pp, s.coupling_pr, s.coupling_rr, {0, 0}};
      if (coupling_seen[i] == 0) moments[i].p = std::numeric_limits<float>::quiet_NaN();  // never read
    }
    DeviceModel device(context(), model), out(context(), model);
    DeviceArray<uint8_t> touched_rows(context(), n, "test"), seen;
    DeviceArray<uint32_t> visible(context(), 1, "test");
    DeviceArray<SplatGradient> main_slots;
    DeviceArray<CouplingMoments> coupling_slots;
    DeviceArray<DensitySums> density_rows(context(), n, "test");
    DeviceArray<double> square_sums(context(), 2, "test"), partial(context(), square_scratch(n), "test");
    DeviceArray<unsigned long long> bad_key;
    main_slots.assign(context(), main, "test");
    coupling_slots.assign(context(), moments, "test");
    seen.assign(context(), coupling_seen, "test");
    bad_key.assign(context(), {kNoBadGradient}, "test");
    mark_touched(context(), view->list_spans(), view->record_spans(), touched_rows.span(), visible.span());
    ParameterGradientSpans in;
    in.model = device.spans();
    in.view = view->view_spans();
    in.lists = view->list_spans();
    in.record = view->record_spans();
    in.touched = touched_rows.span();
    in.slots = main_slots.span();
    if (coupling_scale != 0) in.coupling = coupling_slots.span();
    in.coupling_seen = seen.span();
    in.coupling_scale = coupling_scale;
    in.sh_degree = request.sh_degree;
    parameter_gradients(context(), in,
                        {out.spans(), density_rows.span(), square_sums.span(), partial.span(), bad_key.span()});
    positions = out.positions.to_host();
    log_scales = out.log_scales.to_host();
    rotations = out.rotations.to_host();
    opacity_logits = out.opacity_logits.to_host();
    sh = out.sh.to_host();
    density = density_rows.to_host();
    squares = square_sums.to_host();
    touched = touched_rows.to_host();
    bad = bad_key.to_host()[0];
    EXPECT_EQ(visible.to_host()[0], view->visible);
  }

  cpu::BadGradient run_cpu(float coupling_scale) {
    const cpu::ParameterGradientInputs in{model, view->view, view->lists,   view->record,
                                          slots, request,    view->visible, coupling_scale};
    return cpu::parameter_gradients(in, view->pool, terms, totals, view->cpu_gradients);
  }

  template <class Got, class Want>
  void expect_close(const Got& got, const Want& want, size_t width, bool touched_only, const char* name) {
    std::vector<float> a, b;
    for (size_t i = 0; i < model.size() * width; ++i) {
      if (touched_only && touched[i / width] == 0) continue;
      a.push_back(got[i]);
      b.push_back(want[i]);
    }
    const auto d = difference(a, b);
    EXPECT_LE(d.worst, kParameterTolerance.row_gradient) << name << " " << d.at << ", largest " << d.scale;
  }

  void expect_equal(float coupling_scale) {
    run_device(coupling_scale);
    EXPECT_LT(run_cpu(coupling_scale).row, 0);
    const cpu::ParameterGradients& want = view->cpu_gradients;
    EXPECT_EQ(touched, want.touched);
    expect_close(positions, want.positions, 3, false, "positions");
    expect_close(log_scales, want.log_scales, 3, false, "log_scales");
    expect_close(rotations, want.rotations, 4, false, "rotations");
    expect_close(opacity_logits, want.opacity_logits, 1, false, "opacity_logits");
    expect_close(sh, want.sh, 3 * kShCoefficients, true, "sh");
    const double visible = static_cast<double>(std::max<size_t>(1, view->visible));
    EXPECT_NEAR(std::sqrt(squares[0] / visible), totals.photometric_rms,
                kParameterTolerance.gradient_rms * totals.photometric_rms);
    if (coupling_scale != 0) {
      EXPECT_NEAR(std::sqrt(squares[1] / visible), totals.coupling_rms,
                  kParameterTolerance.gradient_rms * totals.coupling_rms);
    }
    for (size_t i = 0; i < model.size(); ++i) {
      if (touched[i] == 0) continue;
      EXPECT_NEAR(density[i].weight, want.density[i].weight, kParameterTolerance.density_sum) << i;
      EXPECT_NEAR(density[i].photometric_abs_y, want.density[i].photometric_abs_y, kParameterTolerance.density_sum)
          << i;
      EXPECT_NEAR(density[i].unsupported, want.density[i].unsupported, kParameterTolerance.density_sum) << i;
    }
    EXPECT_EQ(bad, kNoBadGradient);
  }

  RandomSceneOptions options;
  GaussianModel model;
  StepRequest request = color_and_class_request();
  std::unique_ptr<TestView> view;
  cpu::SlotGradients slots;
  std::vector<uint8_t> coupling_seen, touched;
  LossTerms terms;
  cpu::ParameterGradientTotals totals;
  std::vector<float> positions, log_scales, rotations, opacity_logits, sh;
  std::vector<DensitySums> density;
  std::vector<double> squares;
  unsigned long long bad = 0;
};

TEST_F(CudaParameterGradients, EqualThoseOfTheCpuEngine) {
  RandomSceneOptions o;
  o.gaussians = 300;
  for (const int degree : {0, 3}) {
    prepare(o);
    request.sh_degree = degree;
    expect_equal(0);
    expect_equal(0.7f);
  }
}

TEST_F(CudaParameterGradients, RowsWithASlotInEveryTile) {
  RandomSceneOptions o;
  o.width = 130;
  o.height = 70;
  o.gaussians = 200;
  o.log_scale_max = 0.5;
  prepare(o);
  uint64_t most = 0;
  for (size_t i = 0; i < model.size(); ++i) {
    most = std::max(most, view->lists.slot_begin[i + 1] - view->lists.slot_begin[i]);
  }
  ASSERT_GE(most, 40u);
  expect_equal(0.7f);
}

TEST_F(CudaParameterGradients, NothingInView) {
  RandomSceneOptions o;
  o.gaussians = 40;
  GaussianModel m = make_model(o);
  for (size_t i = 0; i < m.size(); ++i) m.opacity_logits[i] = -20;
  options = o;
  prepare(m);
  ASSERT_EQ(view->visible, 0u);
  run_device(0);
  for (const std::vector<float>* g : {&positions, &log_scales, &rotations, &opacity_logits}) {
    for (const float x : *g) ASSERT_EQ(x, 0.0f);
  }
  EXPECT_EQ(squares, std::vector<double>(2, 0.0));
  EXPECT_EQ(bad, kNoBadGradient);
}

TEST_F(CudaParameterGradients, TheFirstUnusableRowIsNamed) {
  RandomSceneOptions o;
  o.gaussians = 100;
  prepare(o);
  std::vector<size_t> rows;
  for (size_t i = 0; i < model.size() && rows.size() < 3; ++i) {
    if (view->cpu_gradients.touched[i] != 0) rows.push_back(i);
  }
  const auto poison = [&](size_t row, size_t field, float value) {
    for (uint64_t slot = view->lists.slot_begin[row]; slot < view->lists.slot_begin[row + 1]; ++slot) {
      reinterpret_cast<float*>(&slots[slot])[field] = value;
    }
  };
  poison(rows[2], 8, std::numeric_limits<float>::infinity());  // a moment of the mean
  run_device(0);
  EXPECT_EQ(bad, bad_gradient_key(rows[2], GradientClass::kPositions));
  poison(rows[1], 0, 1e30f);  // finite, but too large for the optimiser
  run_device(0);
  const cpu::BadGradient want = run_cpu(0);
  EXPECT_EQ(want.row, static_cast<int64_t>(rows[1]));
  EXPECT_EQ(bad / 8, rows[1]);
}

}  // namespace
}  // namespace aligngs::cuda
