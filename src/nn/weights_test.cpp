#include "nn/weights.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/stop_signal.h"
#include "nn/testing/weights.h"

namespace aligngs::nn {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::shared_ptr<MemoryWeights> file() {
  auto weights = std::make_shared<MemoryWeights>();
  weights->set("blocks.0.w", {2, 2}, {1, 2, 3, 4});
  weights->set("blocks.1.w", {1, 2}, {5, 6});
  weights->set("blocks.10.w", {1}, {0});
  weights->set("bad", {2}, {1, std::numeric_limits<float>::quiet_NaN()});
  return weights;
}

void expect_weights_error(const std::function<void()>& work, const std::string& field, const std::string& message) {
  try {
    work();
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kWeights);
    EXPECT_EQ(error.details().path, "weights.test");
    EXPECT_EQ(error.details().field, field);
    EXPECT_THAT(error.details().message, HasSubstr(message));
  }
}

TEST(Weights, LoadsATensorOfTheExpectedShape) {
  const Weights weights(file());
  EXPECT_THAT(weights.load("blocks.0.w", {2, 2}), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(weights.sub("blocks.1.").load("w", {1, 2}), ElementsAre(5, 6));
}

TEST(Weights, StopsBetweenTensors) {
  const Weights weights(file());
  request_stop();
  try {
    weights.load("blocks.0.w", {2, 2});
    ADD_FAILURE() << "loaded";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInterrupted);
  }
  clear_stop_request();
}

TEST(Weights, NamesAMissingTensor) {
  const Weights below = Weights(file()).sub("blocks.2.");
  expect_weights_error([&] { below.load("w", {1}); }, "blocks.2.w", "missing");
}

TEST(Weights, NamesExpectedAndFoundShape) {
  const Weights weights(file());
  expect_weights_error(
      [&] {
        weights.load("blocks.0.w", {2, 3});
      },
      "blocks.0.w", "shape (2, 3) expected, (2, 2) found");
  expect_weights_error([&] { weights.dimension("blocks.0.w", 2); }, "blocks.0.w", "fewer than 3");
}

TEST(Weights, RefusesValuesThatAreNotFinite) {
  const Weights weights(file());
  expect_weights_error([&] { weights.load("bad", {2}); }, "bad", "value 1 is not finite");
}

TEST(Weights, CountsNumberedParts) {
  EXPECT_EQ(Weights(file()).count("blocks."), 2);  // 10 does not follow 1
  EXPECT_EQ(Weights(file()).count("layers."), 0);
}

TEST(Weights, JoinsTensorsAlongTheFirstAxis) {
  Weights weights;
  weights.add("joined", file(), {"blocks.0.w", "blocks.1.w"});
  EXPECT_THAT(weights.shape("joined"), ElementsAre(3, 2));
  EXPECT_THAT(weights.load("joined", {3, 2}), ElementsAre(1, 2, 3, 4, 5, 6));
}

TEST(Weights, RefusesToJoinWhatDoesNotFit) {
  Weights weights;
  weights.add("joined", file(), {"blocks.0.w", "bad"});
  expect_weights_error([&] { weights.shape("joined"); }, "bad", "does not continue");
}

TEST(Weights, RenamesAndLeavesOut) {
  Weights weights;
  weights.add_all(
      file(), [](const std::string& name) { return name.rfind("blocks.", 0) == 0 ? "layers." + name.substr(7) : ""; });
  EXPECT_THAT(weights.names(), ElementsAre("layers.0.w", "layers.1.w", "layers.10.w"));
}

}  // namespace
}  // namespace aligngs::nn
