#include "cli/stages/perceptual_metric.h"

#include <gmock/gmock.h>

#include "nn/random_weights.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

class Perceptual : public testing::Test {
 protected:
  void SetUp() override {
    options.folder = fs::path(testing::TempDir()) /
                     ("perceptual_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(options.folder);
    for (size_t i = 0; i < a.data.size(); ++i) {
      a.data[i] = static_cast<float>(i % 97) / 97;
      b.data[i] = static_cast<float>(i % 89) / 89;
    }
  }
  /// A narrow VGG16 with random weights.
  void install() const {
    const PublishedModel& model = published_model("lpips-vgg");
    const ModelStore store(options);
    const std::vector<int64_t> widths = {4, 4, 8, 8, 8};
    nn::write_random_weights(store.own_path(model, model.files[0]), nn::vgg16_tensors(widths), 1);
    nn::write_random_weights(store.own_path(model, model.files[1]), nn::lpips_tensors(widths), 2);
  }

  ModelStoreOptions options;
  ThreadPool pool{2};
  ImageF a{32, 24, 3}, b{32, 24, 3};
};

TEST_F(Perceptual, WithoutWeightsNothingIsMeasuredAndTheReasonIsStated) {
  const PerceptualMetric metric(ModelStore(options), pool);
  EXPECT_FALSE(metric.measure(a, b, {}));
  EXPECT_THAT(metric.reason(), testing::HasSubstr("aligngs models download lpips-vgg"));
}

TEST_F(Perceptual, BothVariantsAreMeasured) {
  install();
  const PerceptualMetric metric(ModelStore(options), pool);
  EXPECT_EQ(metric.reason(), "");
  const auto distances = metric.measure(a, b, {});
  ASSERT_TRUE(distances);
  EXPECT_NE(distances->canonical, 0);
  EXPECT_NE(distances->canonical, distances->unit);
}

TEST_F(Perceptual, EqualImagesAreNoDistanceApart) {
  install();
  const PerceptualMetric metric(ModelStore(options), pool);
  EXPECT_EQ(metric.measure(a, a, {})->canonical, 0);
}

TEST_F(Perceptual, MaskedPixelsCountAsEqual) {
  install();
  const PerceptualMetric metric(ModelStore(options), pool);
  EXPECT_EQ(metric.measure(a, b, ImageF(32, 24, 1, 0.f))->canonical, 0);
}

TEST_F(Perceptual, ImagesTooSmallForTheNetworkAreNotMeasured) {
  install();
  const PerceptualMetric metric(ModelStore(options), pool);
  EXPECT_FALSE(metric.measure(ImageF(12, 24, 3), ImageF(12, 24, 3), {}));
}

TEST_F(Perceptual, DamagedWeightsAreAReasonToo) {
  install();
  const PublishedModel& model = published_model("lpips-vgg");
  fs::resize_file(ModelStore(options).own_path(model, model.files[0]), 100);
  const PerceptualMetric metric(ModelStore(options), pool);
  EXPECT_THAT(metric.reason(), testing::HasSubstr("cannot be used"));
}

}  // namespace
}  // namespace aligngs
