#include "nn/da3/da3.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/error.h"
#include "nn/preprocess/da3_images.h"
#include "nn/testing/small_networks.h"

namespace aligngs::nn {
namespace {

using testing::HasSubstr;

std::vector<FeatureMap> small_images(int count) {
  std::vector<FeatureMap> images;
  for (int i = 0; i < count; ++i) images.push_back(da3_input(small_photo(42, 28, uint64_t(i))));
  return images;
}

class Da3Test : public testing::Test {
 protected:
  std::vector<Da3Frame> run(const Da3& network, int views, const Da3Request& request) {
    std::vector<Da3Frame> frames;
    network(compute_, small_images(views), request, [&](int64_t view, Da3Frame frame) {
      EXPECT_EQ(view, int64_t(frames.size()));
      frames.push_back(std::move(frame));
    });
    return frames;
  }
  Da3 network() { return Da3(compute_, Weights(weights_), small_da3_options()); }
  void expect_refused(const std::string& field) {
    try {
      network();
      FAIL() << "accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kWeights);
      EXPECT_THAT(error.details().field, HasSubstr(field));
    }
  }

  ThreadPool pool_{2};
  Compute compute_{pool_};
  std::shared_ptr<MemoryWeights> weights_ = small_weights(da3_tensors(small_da3_size()));
};

TEST_F(Da3Test, GivesCamerasDepthAndRaysOfEveryView) {
  Da3Request request;
  request.rays = true;
  for (const int views : {1, 2, 3}) {
    const std::vector<Da3Frame> frames = run(network(), views, request);
    ASSERT_EQ(frames.size(), size_t(views));
    for (const Da3Frame& frame : frames) {
      EXPECT_EQ(frame.camera.cx, 21);
      EXPECT_EQ(frame.camera.cy, 14);
      ASSERT_EQ(frame.depth.places(), 28 * 42);
      ASSERT_EQ(frame.rays.height, 16);
      ASSERT_EQ(frame.rays.width, 24);
      for (int64_t p = 0; p < frame.depth.places(); ++p) {
        ASSERT_GT(frame.depth.data[size_t(2 * p)], 0);
        ASSERT_GE(frame.depth.data[size_t(2 * p + 1)], 1);
      }
    }
  }
}

TEST_F(Da3Test, TheOrderOfThePhotosIsThatOfTheResultsWhateverTheReference) {
  const Da3 da3 = network();
  std::vector<FeatureMap> images = small_images(3);
  const auto depths = [&](int64_t reference) {
    Da3Request request;
    request.reference = reference;
    std::vector<Values> out;
    da3(compute_, images, request, [&](int64_t, Da3Frame frame) { out.push_back(frame.depth.data); });
    return out;
  };
  const std::vector<Values> last = depths(2), other = depths(0);
  EXPECT_NE(last[0], other[0]);
  // The last photo put in front, and named as the reference there, is the same order of work.
  std::rotate(images.begin(), images.begin() + 2, images.end());
  const std::vector<Values> front = depths(0);
  EXPECT_EQ(front[0], last[2]);
  EXPECT_EQ(front[1], last[0]);
  EXPECT_EQ(front[2], last[1]);
}

TEST_F(Da3Test, GivenCamerasChangeTheResultAndTheirScaleDoesNot) {
  const Da3 da3 = network();
  Da3Request posed;
  for (int i = 0; i < 3; ++i) {
    NetworkCamera camera;
    camera.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    camera.translation = {0.3 * i, 0.1 * i * i, 0};
    camera.fx = camera.fy = 40;
    camera.cx = 21;
    camera.cy = 14;
    posed.cameras.push_back(camera);
  }
  const std::vector<Da3Frame> alone = run(da3, 3, {}), given = run(da3, 3, posed);
  EXPECT_NE(alone[1].depth.data, given[1].depth.data);
  for (NetworkCamera& camera : posed.cameras) {
    for (double& t : camera.translation) t *= 8;
  }
  const std::vector<Da3Frame> larger = run(da3, 3, posed);
  for (size_t i = 0; i < given[1].depth.data.size(); ++i)
    ASSERT_NEAR(larger[1].depth.data[i], given[1].depth.data[i], 1e-5f * given[1].depth.data[i]);
}

TEST_F(Da3Test, GivenCamerasThatNoPhotoHasAreBadInput) {
  Da3Request request;
  request.cameras.resize(2);  // focal lengths of 0
  EXPECT_THROW(run(network(), 2, request), Error);
  for (NetworkCamera& camera : request.cameras) {
    camera.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    camera.fx = camera.fy = 30;
  }
  EXPECT_THROW(run(network(), 3, request), Error);  // two cameras of three images
}

TEST_F(Da3Test, AReferenceThatCannotBeOneIsAUsageError) {
  const Da3 da3 = network();
  Da3Request request;
  request.reference = 3;
  EXPECT_THROW(run(da3, 3, request), Error);
  request.reference = 0;
  NetworkCamera camera;
  camera.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  camera.fx = camera.fy = 40;
  request.cameras = {camera, camera, camera};
  EXPECT_THROW(run(da3, 3, request), Error);  // the first of given cameras is it
}

TEST_F(Da3Test, TheNumberOfThreadsChangesNoBit) {
  for (const Precision precision : {Precision::kFloat32, Precision::kBfloat16}) {
    std::vector<Values> depths;
    for (const int threads : {1, 3}) {
      ThreadPool pool(threads);
      Compute compute(pool, {precision, true, true});
      const Da3 da3(compute, Weights(weights_), small_da3_options());
      da3(compute, small_images(3), {}, [&](int64_t view, Da3Frame frame) {
        if (view == 2) depths.push_back(frame.depth.data);
      });
    }
    EXPECT_EQ(depths[0], depths[1]);
  }
}

TEST_F(Da3Test, TheAnyViewPartOfANestedFileIsFound) {
  TensorList tensors = da3_tensors(small_da3_size());
  const auto nested = std::make_shared<MemoryWeights>();
  for (const SafetensorsStream::Entry& tensor : tensors)
    nested->set("model.da3." + tensor.name.substr(6), tensor.shape, weights_->read(tensor.name));
  const Da3 other(compute_, Weights(nested), small_da3_options());
  EXPECT_EQ(run(other, 2, {})[1].depth.data, run(network(), 2, {})[1].depth.data);
}

TEST_F(Da3Test, TheSharedNormIsTakenFromTheLevelThatHasIt) {
  const std::string norm = "model.head.scratch.output_conv2_aux.";
  Da3Request request;
  request.rays = true;
  const Values before = run(network(), 1, request)[0].rays.data;
  weights_->set(norm + "3.2.weight", {32}, weights_->read(norm + "0.2.weight"));
  weights_->set(norm + "3.2.bias", {32}, weights_->read(norm + "0.2.bias"));
  weights_->set(norm + "0.2.weight", {32}, std::vector<float>(32, 9.0f));
  EXPECT_EQ(run(network(), 1, request)[0].rays.data, before);
}

TEST_F(Da3Test, WithoutTheRayBranchRaysAreRefusedAndTheRestWorks) {
  weights_->forget("model.head.scratch.output_conv2_aux.3.5.weight");
  EXPECT_EQ(run(network(), 1, {}).size(), 1u);
  Da3Request request;
  request.rays = true;
  EXPECT_THROW(run(network(), 1, request), Error);
}

TEST_F(Da3Test, WhatIsMissingIsNamed) {
  weights_->forget("model.cam_dec.fc_t.weight");
  expect_refused("cam_dec.fc_t.weight");
}

TEST_F(Da3Test, WeightsOfAnotherNetworkAreRefused) {
  weights_ = small_weights(dinov2_tensors({32, 4, false, 0, 4}));
  expect_refused("backbone.pretrained.cls_token");
}

TEST_F(Da3Test, ADepthThatIsNotPublishedNeedsItsLayers) {
  EXPECT_THROW(Da3(compute_, Weights(weights_)), Error);
  Da3Options wrong = small_da3_options();
  wrong.trunk.layers = {2, 3, 3, 5};
  EXPECT_THROW(Da3(compute_, Weights(weights_), wrong), Error);
}

TEST_F(Da3Test, MetricDepthAndSkyComeAtTheSizeOfTheImage) {
  const Da3Metric metric(compute_, Weights(small_weights(da3_metric_tensors(small_da3_metric_size()))),
                         small_da3_metric_options());
  const FeatureMap map = metric(compute_, small_images(1)[0]);
  ASSERT_EQ(map.places(), 28 * 42);
  ASSERT_EQ(map.channels, 2);
  for (int64_t p = 0; p < map.places(); ++p) {
    ASSERT_GT(map.data[size_t(2 * p)], 0);
    ASSERT_GE(map.data[size_t(2 * p + 1)], 0);
  }
}

}  // namespace
}  // namespace aligngs::nn
