#include "priors/network_memory.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "nn/eomt/eomt_weights.h"
#include "nn/random_weights.h"
#include "priors/da3_prediction.h"
#include "priors/vggt_prediction.h"

namespace aligngs {
namespace {

using testing::HasSubstr;

constexpr NetworkMemoryOptions kBfloat16{nn::Precision::kBfloat16, 2};
constexpr double kGigabyte = 1e9;

/// The header of a weight file, which is all that a prediction reads.
class HeaderOnly : public WeightFile {
 public:
  explicit HeaderOnly(const nn::TensorList& tensors) : WeightFile("header.test") {
    for (const SafetensorsStream::Entry& tensor : tensors) tensors_[tensor.name] = {"F16", tensor.shape};
  }
  std::vector<float> read(const std::string& tensor) const override {
    ADD_FAILURE() << tensor << " was read";
    return {};
  }
};

nn::Weights published(const nn::TensorList& tensors) { return nn::Weights(std::make_shared<HeaderOnly>(tensors)); }
nn::Weights backbone(char size) { return published(nn::dinov2_tensors(nn::vit_size(size))); }

double gigabytes(const MemoryBudget& budget) { return double(budget.total()) / kGigabyte; }

/// Not below what was measured (benchmarks/README.md), nor far above.
void expect_near(const MemoryBudget& budget, double measured_gigabytes) {
  EXPECT_GE(gigabytes(budget), 0.98 * measured_gigabytes) << budget.table();
  EXPECT_LE(gigabytes(budget), 1.15 * measured_gigabytes) << budget.table();
}

TEST(NetworkMemory, AgreesWithMeasuredPeaks) {
  MemoryBudget m2f;
  add_mask2former_memory(m2f, published(nn::mask2former_tensors({})), {896, 896}, kBfloat16);
  expect_near(m2f, 5.87);

  MemoryBudget dpt;
  add_depth_network_memory(dpt, backbone('l'), published(nn::dpt_head_tensors(nn::vit_size('l'))), {640, 480},
                           kBfloat16);
  expect_near(dpt, 1.22);

  MemoryBudget vggt;
  add_vggt_memory(vggt, published(nn::vggt_tensors({})), nn::Precision::kBfloat16, 20, 518, 392);
  expect_near(vggt, 3.81);

  constexpr NetworkMemoryOptions kFloat32{nn::Precision::kFloat32, 2};
  const nn::Weights base = published(nn::da3_tensors(nn::da3_size('b')));
  MemoryBudget da3, da3_exact;
  add_da3_memory(da3, base, nn::Precision::kBfloat16, 20, 504, 378);
  expect_near(da3, 1.09);
  add_da3_memory(da3_exact, base, nn::Precision::kFloat32, 20, 504, 378);
  expect_near(da3_exact, 1.31);

  const nn::Weights large = nn::eomt_weights(std::make_shared<HeaderOnly>(nn::eomt_tensors()));
  MemoryBudget eomt, eomt_exact;
  add_eomt_memory(eomt, large, 4. / 3, kBfloat16);
  expect_near(eomt, 1.16);
  add_eomt_memory(eomt_exact, large, 4. / 3, kFloat32);
  expect_near(eomt_exact, 1.78);
}

TEST(NetworkMemory, APhotoOfSeveralWindowsNeedsRoomForAllItsValues) {
  const nn::SegmentationPlan plan = nn::mask2former_plan();
  const NetworkInput image = largest_planned_image(plan, 779, 520);
  EXPECT_EQ(image.width, 1344);
  EXPECT_EQ(image.height, 896);
  EXPECT_EQ(planned_window(plan, image).width, 896);
  MemoryBudget one, two;
  add_sliding_memory(one, plan, {896, 896}, 150);
  add_sliding_memory(two, plan, image, 150);
  EXPECT_LT(gigabytes(one), 0.1);
  EXPECT_NEAR(gigabytes(two), 1344. * 896 * (150 * 4 + 36) / kGigabyte, 1e-3);
}

TEST(NetworkMemory, AugmentationShowsLargerImages) {
  EXPECT_EQ(largest_planned_image(nn::multi_scale_plan(false), 640, 640).width, 640);
  EXPECT_EQ(largest_planned_image(nn::multi_scale_plan(true), 640, 640).width, 1920);
}

TEST(NetworkMemory, GrowsWithTheNetworkThePrecisionAndTheImage) {
  const auto head_of = [](char size) { return published(nn::bn_head_tensors(nn::vit_size(size).channels)); };
  const auto needed = [&](char size, NetworkInput window, NetworkMemoryOptions options) {
    MemoryBudget budget;
    add_bn_head_memory(budget, backbone(size), head_of(size), window, options);
    return gigabytes(budget);
  };
  const double small = needed('s', {512, 512}, kBfloat16);
  EXPECT_LT(small, needed('b', {512, 512}, kBfloat16));
  EXPECT_LT(small, needed('s', {640, 640}, kBfloat16));
  EXPECT_LT(small, needed('s', {512, 512}, {nn::Precision::kFloat32, 2}));
}

TEST(NetworkMemory, AFileOfAnotherNetworkIsAnError) {
  MemoryBudget budget;
  EXPECT_THROW(add_mask2former_memory(budget, backbone('s'), {896, 896}, kBfloat16), Error);
  EXPECT_THROW(add_bn_head_memory(budget, backbone('s'), backbone('s'), {512, 512}, kBfloat16), Error);
}

}  // namespace
}  // namespace aligngs
