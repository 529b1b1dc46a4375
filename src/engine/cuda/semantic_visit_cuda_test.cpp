// Semantic rows, the visit to every tile and the way back to the logits, against the CPU engine in float32.
#include "engine/cuda/semantic_visit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "core/error.h"
#include "device/tolerances.h"
#include "engine/cpu/semantic_rows.h"
#include "engine/cpu/semantic_visit.h"
#include "engine/cuda/parameter_gradients.h"
#include "engine/cuda/testing/view.h"
#include "engine/formulas/semantic_loss.h"
#include "engine/testing/request.h"
#include "scene/semantic_target.h"
#ifdef ALIGNGS_CUDA_EMULATED
#include "device/emulation/emulation.h"
#endif

namespace aligngs::cuda {
namespace {

using cpu::testing_scene::difference;
using cpu::testing_scene::make_camera;
using cpu::testing_scene::make_model;
using cpu::testing_scene::make_view;
using cpu::testing_scene::RandomSceneOptions;

const CudaTolerance kVisitTolerance;

/// The gradient -t / Q of blended probabilities jumps to 0 at the floor of Q. With logits this close together every Q
/// stays above it, whatever the rounding.
constexpr float kAboveTheFloor = 0.5f;

struct Options {
  RandomSceneOptions scene;
  SemanticBlend blend = SemanticBlend::kProbabilities;
  SemanticCoupling coupling = SemanticCoupling::kBounded;
  bool couple = true;
  int remainder = 0;
  SemanticSample sample;
  bool opaque_front = false;  ///< rows 0 and 1 cover everything with alpha 0.95
};

/// Outputs of a visit, by either engine.
struct Outcome {
  double soft = 0, hard = 0;
  std::vector<float> features;   ///< [visible][padded] dL/drows
  std::vector<float> gradients;  ///< [visible][padded] dL/dlogits
  std::vector<uint8_t> written;  ///< [N]
  std::vector<float> moments;    ///< [N][6] of the coupling, in the order of CouplingMoments
};

/// Every test for both methods.
class CudaSemanticVisit : public DeviceTest, public testing::WithParamInterface<SemanticVisitMethod> {
 protected:
  void prepare(const Options& o) {
    options = o;
    model = make_model(o.scene);
    if (o.blend == SemanticBlend::kProbabilities) {
      for (float& x : model.semantics) x *= kAboveTheFloor;
    }
    const Camera camera = make_camera(o.scene.width, o.scene.height);
    if (o.opaque_front) cover(camera);
    training = make_view(o.scene);
    losses.semantic_blend = o.blend;
    losses.coupling = o.coupling;
    losses.weight[Loss::kSemanticHard] = 0.3f;
    losses.semantic_sample = o.sample;
    view = std::make_unique<TestView>(context(), model, camera, RasterSettings{});
    channels = static_cast<size_t>(o.scene.channels);
    padded = static_cast<size_t>(padded_channels(o.scene.channels));
    counts = cpu::make_class_counts(o.scene.channels, o.remainder);
    cache = {};
    prepare_semantic_view(training, counts.classes(), view->pool, cache);
    ASSERT_GT(cache.valid, 0u);
  }

  void cover(const Camera& camera) {
    const Rigidd to_world = camera.world_to_camera.inverse();
    for (size_t i = 0; i < 2; ++i) {
      const double z = 0.5 + 0.1 * static_cast<double>(i);
      const Vec3d p = to_world * (camera.ray(0.5 * camera.width, 0.5 * camera.height) * z);
      for (size_t k = 0; k < 3; ++k) model.positions[3 * i + k] = static_cast<float>(p[static_cast<int>(k)]);
      for (size_t k = 0; k < 3; ++k) model.log_scales[3 * i + k] = 3.0f;
      model.opacity_logits[i] = std::log(0.95f / 0.05f);
    }
  }

  Outcome run_cpu() {
    const size_t visible = view->lists.visible.size(), n = model.size();
    AlignedArray features(visible * padded), gradients(visible * padded);
    for (size_t i = 0; i < n; ++i) {
      if (view->view.rects[i].area() == 0) continue;
      float* row = features.data() + view->lists.rank[i] * padded;
      if (options.blend == SemanticBlend::kProbabilities) {
        cpu::softmax_row(&model.semantics[i * channels], channels, padded, counts.last_log_count(), row);
      } else {
        cpu::copy_row(&model.semantics[i * channels], channels, padded, row);
      }
    }
    std::vector<uint8_t> written;
    cpu::SemanticPass pass;
    pass.step = {&training, &cache, &losses, &counts, options.scene.channels, padded, options.couple};
    pass.rank = view->lists.rank.data();
    pass.features = features.data();
    pass.gradients = gradients.data();
    pass.written = &written;
    pass.visible = visible;
    MapGradients<float> none;
    none.reset(view->maps.pixels());
    cpu::SlotGradients slots;
    cpu::RowBatches batches;
    cpu::backward_pass({view->view, view->lists, view->raster}, view->record, {none, nullptr, nullptr, 1.0f}, false,
                       false, &pass, view->pool, view->scratch, batches, slots);
    Outcome out;
    out.soft = pass.soft;
    out.hard = pass.hard;
    out.features.assign(visible * padded, 0.0f);
    out.gradients.assign(visible * padded, 0.0f);
    out.written.assign(n, 0);
    out.moments.assign(6 * n, 0.0f);
    for (size_t i = 0; i < n; ++i) {
      if (view->view.rects[i].area() == 0) continue;
      const size_t at = view->lists.rank[i] * padded;
      out.written[i] = written[view->lists.rank[i]];
      for (uint64_t slot = view->lists.slot_begin[i]; slot < view->lists.slot_begin[i + 1] && options.couple; ++slot) {
        if (view->record.seen[slot] == 0) continue;
        const cpu::CoupledSplatGradient& s = slots[slot];
        const float moments[6] = {s.coupling_p,  s.coupling_r,  s.coupling_one,
                                  s.coupling_pp, s.coupling_pr, s.coupling_rr};
        for (size_t k = 0; k < 6; ++k) out.moments[6 * i + k] += moments[k];
      }
      if (out.written[i] == 0) continue;
      std::copy_n(gradients.data() + at, channels, &out.features[at]);
      if (options.blend == SemanticBlend::kProbabilities) {
        softmax_backward(features.data() + at, gradients.data() + at, options.scene.channels, &out.gradients[at]);
      } else {
        std::copy_n(gradients.data() + at, channels, &out.gradients[at]);
      }
    }
    return out;
  }

  Outcome run_device() {
    const size_t visible = view->lists.visible.size(), n = model.size(), instances = view->lists.instances();
    DeviceModel device(context(), model);
    TeacherMaps teacher(context(), training, cache);
    DeviceArray<uint8_t> touched, seen(context(), instances, "test"), written(context(), n, "test");
    touched.assign(context(), view->cpu_gradients.touched, "test");
    DeviceArray<uint16_t> rows(context(), visible * padded, "test");
    DeviceArray<float> row_slots(context(), instances * padded, "test"), gradients(context(), visible * padded, "test");
    DeviceArray<CouplingMoments> coupling(context(), instances, "test");
    DeviceArray<double> tile_terms(context(), 2 * view->view.tiles(), "test"), terms(context(), 2, "test");
    DeviceArray<unsigned long long> bad_key;
    bad_key.assign(context(), {kNoBadGradient}, "test");

    SemanticRowInputs row_inputs;
    row_inputs.model = device.spans();
    row_inputs.touched = touched.span();
    row_inputs.rank = view->list_spans().rank;
    row_inputs.blend = options.blend;
    row_inputs.remainder = options.remainder;
    semantic_rows(context(), row_inputs, rows.span());

    SemanticVisitInputs in;
    in.view = view->view_spans();
    in.lists = view->list_spans();
    in.record = view->record_spans();
    in.teacher = teacher.spans();
    in.rows = rows.span();
    in.raster = view->raster;
    in.blend = options.blend;
    in.coupling = options.coupling;
    in.couple = options.couple;
    in.soft_weight = losses.weight[Loss::kSemanticSoft];
    in.hard_weight = losses.weight[Loss::kSemanticHard];
    in.remainder = options.remainder;
    in.sample = losses.semantic_sample;
    in.method = GetParam();
    SemanticVisitOutputs out{row_slots.span(), {}, seen.span(), tile_terms.span(), terms.span()};
    if (options.couple) out.coupling = coupling.span();
    semantic_visit(context(), in, out);

    SemanticGradientInputs gradient_inputs;
    gradient_inputs.rows = row_inputs;
    gradient_inputs.lists = view->list_spans();
    gradient_inputs.row_slots = row_slots.span();
    gradient_inputs.seen = seen.span();
    semantic_gradients(context(), gradient_inputs, {gradients.span(), written.span(), bad_key.span()});

    Outcome result;
    const std::vector<double> values = terms.to_host();
    result.soft = values[0];
    result.hard = values[1];
    result.written = written.to_host();
    bad = bad_key.to_host()[0];
    const std::vector<float> slot_rows = row_slots.to_host(), logits = gradients.to_host();
    const std::vector<CouplingMoments> moments = coupling.to_host();
    const std::vector<uint8_t> seen_slots = seen.to_host();
    result.features.assign(visible * padded, 0.0f);
    result.gradients.assign(visible * padded, 0.0f);
    result.moments.assign(6 * n, 0.0f);
    for (size_t i = 0; i < n; ++i) {
      const size_t at = view->lists.rank[i] * padded;
      for (uint64_t slot = view->lists.slot_begin[i]; slot < view->lists.slot_begin[i + 1]; ++slot) {
        if (seen_slots[slot] == 0) continue;
        for (size_t c = 0; c < padded; ++c) result.features[at + c] += slot_rows[slot * padded + c];
        for (size_t k = 0; k < 6 && options.couple; ++k) {
          result.moments[6 * i + k] += reinterpret_cast<const float*>(&moments[slot])[k];
        }
      }
      if (result.written[i] != 0) std::copy_n(&logits[at], padded, &result.gradients[at]);
    }
    return result;
  }

  void expect_close() {
    SCOPED_TRACE(testing::Message() << model.size() << " Gaussians, " << channels << " channels, blend "
                                    << int(options.blend) << ", coupling " << int(options.coupling) << ", remainder "
                                    << options.remainder);
    const Outcome want = run_cpu(), got = run_device();
    EXPECT_NEAR(got.soft, want.soft, kVisitTolerance.visit_loss);
    EXPECT_NEAR(got.hard, want.hard, kVisitTolerance.visit_loss);
    EXPECT_EQ(got.written, want.written);
    EXPECT_EQ(bad, kNoBadGradient);
    const double valid = static_cast<double>(cache.valid);
    if (channels == 1 && options.blend == SemanticBlend::kLogits) {  // one class: nothing to learn
      for (const float g : got.features) EXPECT_NEAR(g, 0, kVisitTolerance.nothing / valid);
      return;
    }
    expect_near(got.features, want.features, kVisitTolerance.semantic_gradient, "dL/drow");
    // The row of one class is always 1.
    if (channels > 1) expect_near(got.gradients, want.gradients, kVisitTolerance.semantic_gradient, "dL/dlogit");
    if (channels == 1 && options.coupling == SemanticCoupling::kBounded) return;  // rounding of 0
    // Whitened coordinates are of order 1, so the six moments share a scale; single ones may cancel.
    expect_near(got.moments, want.moments, kVisitTolerance.coupling_moment, "moment");
  }

  static void expect_near(const std::vector<float>& got, const std::vector<float>& want, double tolerance,
                          const std::string& name) {
    const auto d = difference(got, want);
    EXPECT_LE(d.worst, tolerance) << name << ", number " << d.at << ", largest " << d.scale;
  }

  void expect_close_with_every_loss(Options o) {
    for (const SemanticBlend blend : {SemanticBlend::kProbabilities, SemanticBlend::kLogits}) {
      for (const SemanticCoupling coupling :
           {SemanticCoupling::kBounded, SemanticCoupling::kPlain, SemanticCoupling::kOpacity}) {
        o.blend = blend;
        o.coupling = coupling;
        prepare(o);
        expect_close();
      }
    }
  }

  static Options small_scene() {
    Options o;
    o.scene.width = 29;  // neither a multiple of the tile nor of the block
    o.scene.height = 19;
    o.scene.gaussians = 60;
    return o;
  }

  using AlignedArray = cpu::AlignedArray<float>;
  Options options;
  GaussianModel model;
  TrainingView training;
  LossSettings losses = color_and_class_losses();
  std::unique_ptr<TestView> view;
  SemanticView cache;
  cpu::ClassCounts counts;
  size_t channels = 0, padded = 0;
  unsigned long long bad = 0;
};

INSTANTIATE_TEST_SUITE_P(BothMethods, CudaSemanticVisit,
                         testing::Values(SemanticVisitMethod::kCompacted, SemanticVisitMethod::kDense),
                         [](const auto& method) {
                           return method.param == SemanticVisitMethod::kCompacted ? "Compacted" : "Dense";
                         });

TEST(CudaSemanticVisitMethod, FollowsTheDeviceUnlessAskedFor) {
  using M = SemanticVisitMethod;
  const size_t kilobyte = 1024;
  const VisitDevice ampere{8, 0, 163 * kilobyte}, geforce{8, 9, 99 * kilobyte}, hopper{9, 0, 227 * kilobyte},
      blackwell{10, 0, 227 * kilobyte}, geforce_blackwell{12, 0, 99 * kilobyte};
  for (const VisitDevice& device : {ampere, hopper, blackwell}) {
    EXPECT_EQ(semantic_visit_method(M::kAutomatic, device, 40), M::kDense);
  }
  for (const VisitDevice& device : {VisitDevice{8, 6, 99 * kilobyte}, geforce, geforce_blackwell}) {
    EXPECT_EQ(semantic_visit_method(M::kAutomatic, device, 20), M::kCompacted);
  }
  EXPECT_EQ(semantic_visit_method(M::kCompacted, hopper, 40), M::kCompacted);
  EXPECT_EQ(semantic_visit_method(M::kDense, geforce, 20), M::kDense);
  // All classes of ADE20K fit at once on sm_90, on sm_80 they do not.
  EXPECT_EQ(semantic_visit_method(M::kAutomatic, hopper, 150), M::kDense);
  EXPECT_EQ(semantic_visit_method(M::kAutomatic, ampere, 150), M::kCompacted);
  EXPECT_EQ(semantic_visit_method(M::kDense, hopper, kMaxSemanticChannels), M::kCompacted);
}

TEST_P(CudaSemanticVisit, EveryNumberOfClasses) {
  for (const int count : {1, 7, 150, 151}) {
    Options o = small_scene();
    o.scene.channels = count;
    expect_close_with_every_loss(o);
  }
}

TEST_P(CudaSemanticVisit, AsManyChannelsAsItTakes) {
  Options o = small_scene();
  o.scene.channels = kMaxSemanticChannels;
  o.scene.gaussians = 30;
  prepare(o);
  expect_close();
}

TEST_P(CudaSemanticVisit, NoGaussianAndOne) {
  for (const size_t gaussians : {size_t(0), size_t(1)}) {
    Options o = small_scene();
    o.scene.gaussians = gaussians;
    o.scene.log_scale_min = -2;
    o.scene.seed = 4;
    expect_close_with_every_loss(o);
  }
}

TEST_P(CudaSemanticVisit, MoreGaussiansInATileThanAreListedAtATime) {
  Options o;
  o.scene.width = o.scene.height = 16;
  o.scene.gaussians = 2600;
  o.scene.channels = 17;
  o.scene.log_scale_min = -2;
  o.scene.logit_min = -5.4;  // 1/255 is at -5.54
  o.scene.logit_max = -5.0;
  prepare(o);
  ASSERT_GT(view->lists.instances(), 2000u);
  ASSERT_GT(view->visible, 2000u);
  expect_close();
}

TEST_P(CudaSemanticVisit, LastChannelThatStandsForManyClasses) {
  Options o = small_scene();
  o.scene.channels = 20;
  o.remainder = 60;
  expect_close_with_every_loss(o);
}

TEST_P(CudaSemanticVisit, PartOfThePixels) {
  for (const SemanticSample sample : {SemanticSample{2, 1, 4}, SemanticSample{1, 2, 4}}) {
    Options o = small_scene();
    o.scene.width = 61;  // four by three squares: roundings of a few pixels alone would not average
    o.scene.height = 45;
    o.sample = sample;
    expect_close_with_every_loss(o);
  }
}

TEST_P(CudaSemanticVisit, WithoutCouplingTheRowsAreTheSame) {
  Options o = small_scene();
  prepare(o);
  const Outcome coupled = run_device();
  options.couple = false;
  const Outcome alone = run_device();
  EXPECT_EQ(alone.gradients, coupled.gradients);
  EXPECT_EQ(alone.soft, coupled.soft);
  EXPECT_EQ(alone.hard, coupled.hard);
}

/// Behind an opaque surface dL/dalpha is T (q - the blend behind) with T < 0.01. A total with other rounding than the
/// summed q would drown it. The error must be small beside the largest gradient *behind the surface*.
TEST_P(CudaSemanticVisit, AlphaGradientsBehindAnOpaqueSurface) {
  for (const SemanticBlend blend : {SemanticBlend::kProbabilities, SemanticBlend::kLogits}) {
    for (const SemanticCoupling coupling :
         {SemanticCoupling::kBounded, SemanticCoupling::kPlain, SemanticCoupling::kOpacity}) {
      SCOPED_TRACE(testing::Message() << "blend " << int(blend) << ", coupling " << int(coupling));
      Options o = small_scene();
      o.scene.channels = 150;
      o.opaque_front = true;
      o.blend = blend;
      o.coupling = coupling;
      prepare(o);
      for (const float a : view->maps.alpha) ASSERT_GT(a, 0.99f);
      const Outcome want = run_cpu(), got = run_device();
      double largest = 0, worst = 0;
      for (size_t i = 2; i < model.size(); ++i) {
        const double x = static_cast<double>(want.moments[6 * i + 2]), y = static_cast<double>(got.moments[6 * i + 2]);
        largest = std::max(largest, std::abs(x));
        worst = std::max(worst, std::abs(x - y));
      }
      EXPECT_GT(largest, 0.0);
      EXPECT_LE(worst, kVisitTolerance.hidden_moment * largest);
    }
  }
}

TEST_P(CudaSemanticVisit, ATeacherFinerThanTheImageAndOneThatKnowsEverything) {
  Options o = small_scene();
  prepare(o);
  SemanticTarget& t = training.data.semantics;
  const SemanticTarget coarse = t;
  t.width *= 4;
  t.height *= 4;
  t.confidence.clear();
  t.probabilities.clear();
  for (int y = 0; y < t.height; ++y) {
    for (int x = 0; x < t.width; ++x) {
      const size_t from = (size_t(y / 4) * coarse.width + x / 4) * channels;
      t.probabilities.insert(t.probabilities.end(), coarse.probabilities.begin() + static_cast<std::ptrdiff_t>(from),
                             coarse.probabilities.begin() + static_cast<std::ptrdiff_t>(from + channels));
    }
  }
  normalise_target(t);
  training.semantic_weight = ImageF();
  prepare_semantic_view(training, counts.classes(), view->pool, cache);
  ASSERT_EQ(cache.valid, view->maps.pixels());
  expect_close();
}

TEST_P(CudaSemanticVisit, ARowThatIsNotANumberIsReported) {
  Options o = small_scene();
  prepare(o);
  size_t row = 0;
  while (view->cpu_gradients.touched[row] == 0) ++row;
  model.semantics[row * channels + 1] = std::numeric_limits<float>::quiet_NaN();
  const Outcome got = run_device();
  EXPECT_TRUE(std::isnan(got.soft));
  EXPECT_EQ(bad % 8, static_cast<unsigned long long>(GradientClass::kSemantics));
}

TEST_P(CudaSemanticVisit, MoreChannelsThanAVisitHoldsAreAnError) {
  check_semantic_channels(context(), 150);
  try {
    check_semantic_channels(context(), kMaxSemanticChannels + 1);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kResources);
    EXPECT_THAT(e.details().remedy, testing::HasSubstr("--device cpu"));
  }
}

TEST_P(CudaSemanticVisit, TeacherMapsSayTheirSize) {
  Options o = small_scene();
  prepare(o);
  const uint64_t before = context().used();
  const TeacherMaps maps(context(), training, cache);
  const uint64_t used = context().used() - before;
  const SemanticTarget& t = training.data.semantics;
  EXPECT_EQ(used, TeacherMaps::bytes(t.channels, t.confidence.size(), view->maps.pixels()));
}

#ifdef ALIGNGS_CUDA_EMULATED
TEST_P(CudaSemanticVisit, NoBarrierIsMissing) {
  Options o = small_scene();
  o.scene.gaussians = 40;
  for (const SemanticBlend blend : {SemanticBlend::kProbabilities, SemanticBlend::kLogits}) {
    o.blend = blend;
    prepare(o);
    const Outcome want = run_device();
    for (const ThreadOrder order : {ThreadOrder::kReverse, ThreadOrder::kShuffled}) {
      const ScopedThreadOrder scope(order, 11);
      const Outcome got = run_device();
      EXPECT_EQ(got.gradients, want.gradients);
      EXPECT_EQ(got.moments, want.moments);
      EXPECT_EQ(got.soft, want.soft);
    }
  }
}
#endif

}  // namespace
}  // namespace aligngs::cuda
