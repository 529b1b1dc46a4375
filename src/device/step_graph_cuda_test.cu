// When operations become a graph, when a graph is only updated, and when they are launched one by one after all.
#include "device/step_graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "core/error.h"
#include "device/block_reduce.cuh"
#include "device/launch.h"
#include "device/sort_scan.h"
#include "device/testing/device.h"

namespace aligngs::cuda {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;

__global__ void add_kernel(DeviceSpan<float> values, float x) {
  if (item_index() < values.size) values[item_index()] += x;
}
__global__ void scale_kernel(DeviceSpan<float> values, float x) {
  if (item_index() < values.size) values[item_index()] *= x;
}

class CudaStepGraph : public DeviceTest {
 protected:
  void SetUp() override {
    DeviceTest::SetUp();
    if (!IsSkipped()) values.assign(context(), std::vector<float>(40, 1.0f), "test");
  }
  void add(float x) { launch(context(), "add", add_kernel, one_per_item(values.size(), 32), values.span(), x); }
  void scale(float x) { launch(context(), "scale", scale_kernel, one_per_item(values.size(), 32), values.span(), x); }

  DeviceArray<float> values;
};

TEST_F(CudaStepGraph, NewArgumentsUpdateTheGraph) {
  StepGraph graph(context(), true);
  for (const float x : {1.0f, 2.0f, 4.0f}) {
    graph.run([&] {
      add(x);
      scale(2);
    });
  }
  EXPECT_THAT(values.to_host(), Each(32.0f));  // (((1 + 1) 2 + 2) 2 + 4) 2
  EXPECT_EQ(graph.counts().instantiated, 1u);
  EXPECT_EQ(graph.counts().updated, 2u);
  EXPECT_EQ(graph.counts().launched, 3u);
  EXPECT_EQ(graph.counts().plain, 0u);
  EXPECT_EQ(graph.counts().nodes, 2u);
}

TEST_F(CudaStepGraph, OtherOperationsMakeAnotherGraph) {
  StepGraph graph(context(), true);
  graph.run([&] { add(1); });
  graph.run([&] {
    add(1);
    fill_zero(context(), values.span());
    add(7);
  });
  EXPECT_THAT(values.to_host(), Each(7.0f));
  EXPECT_EQ(graph.counts().instantiated, 2u);
  EXPECT_EQ(graph.counts().updated, 0u);
}

TEST_F(CudaStepGraph, SortsScansAndCopiesAreOperationsToo) {
  DeviceArray<uint32_t> keys, rows, sorted(context(), 3, "test"), order(context(), 3, "test");
  keys.assign(context(), {5, 1, 3}, "test");
  rows.assign(context(), {0, 1, 2}, "test");
  const PinnedMemory pinned(context(), sizeof(uint32_t));
  DeviceArena arena(context());
  const auto body = [&] {
    sort_pairs(arena, keys.span(), rows.span(), sorted.span(), order.span(), 8);
    exclusive_scan(arena, sorted.span(), sorted.span());
    copy(context(), rows.span(), order.span());
    context().copy_to_host_later(pinned.data(), rows.span().data, sizeof(uint32_t));
  };
  body();  // takes the arena's memory
  rows.assign(context(), {0, 1, 2}, "test");
  context().synchronise();
  *static_cast<uint32_t*>(pinned.data()) = 9;
  arena.reset();
  StepGraph graph(context(), true);
  graph.run(body);
  context().synchronise();
  EXPECT_EQ(graph.counts().launched, 1u) << graph.reason();
  EXPECT_THAT(rows.to_host(), ElementsAre(1, 2, 0));
  EXPECT_THAT(sorted.to_host(), ElementsAre(0, 1, 4));
  EXPECT_EQ(*static_cast<uint32_t*>(pinned.data()), 1u);
}

TEST_F(CudaStepGraph, WhatWaitsIsLaunchedOneByOne) {
  StepGraph graph(context(), true);
  const auto waiting = [&] {
    add(1);
    context().synchronise();
  };
  graph.run(waiting);
  EXPECT_THAT(values.to_host(), Each(2.0f)) << "once, not twice";
  EXPECT_EQ(graph.counts().failed, 1u);
  EXPECT_EQ(graph.counts().plain, 1u);
  EXPECT_FALSE(graph.reason().empty());
  EXPECT_TRUE(graph.on());
  graph.run([&] { add(1); });
  EXPECT_THAT(values.to_host(), Each(3.0f));
  EXPECT_EQ(graph.counts().launched, 1u);
}

TEST_F(CudaStepGraph, WhatNeedsMoreMemoryTakesItOneByOneAndIsNoFailure) {
  StepGraph graph(context(), true);
  DeviceArray<float> more;
  for (uint64_t i = 0; i <= StepGraph::kMostFailures; ++i) {
    const auto grows = [&] {
      add(1);
      more.resize(context(), 100 << (2 * i), "test");
    };
    graph.run(grows);
    EXPECT_EQ(graph.counts().grown, i + 1);
    graph.run(grows);  // it is there now
    EXPECT_EQ(graph.counts().launched, i + 1);
  }
  EXPECT_TRUE(graph.on());
  EXPECT_EQ(graph.counts().failed, 0u);
  EXPECT_THAT(values.to_host(), Each(1.0f + 2 * (StepGraph::kMostFailures + 1)));
}

TEST_F(CudaStepGraph, AfterSomeFailuresInARowItGivesUp) {
  StepGraph graph(context(), true);
  const auto waiting = [&] { context().synchronise(); };
  for (uint64_t i = 1; i < StepGraph::kMostFailures; ++i) graph.run(waiting);
  graph.run([&] { add(1); });  // a success: the count starts again
  for (uint64_t i = 1; i < StepGraph::kMostFailures; ++i) graph.run(waiting);
  EXPECT_TRUE(graph.on());
  graph.run(waiting);
  EXPECT_FALSE(graph.on());
  const uint64_t failed = graph.counts().failed;
  graph.run([&] { add(1); });
  EXPECT_EQ(graph.counts().failed, failed);
  EXPECT_THAT(values.to_host(), Each(3.0f));
}

TEST_F(CudaStepGraph, AnErrorOfTheStepIsThrownAndTheStreamGoesOn) {
  StepGraph graph(context(), true);
  EXPECT_THROW(graph.run([&] {
    add(1);
    throw_resources({}, "too many pairs", "take fewer");
  }),
               Error);
  context().synchronise();
  values.assign(context(), std::vector<float>(40, 1.0f), "test");
  graph.run([&] { add(1); });
  EXPECT_THAT(values.to_host(), Each(2.0f));
}

TEST_F(CudaStepGraph, DroppedItIsMadeAnew) {
  StepGraph graph(context(), true);
  graph.run([&] { add(1); });
  graph.drop();
  graph.run([&] { add(1); });
  EXPECT_EQ(graph.counts().instantiated, 2u);
  EXPECT_EQ(graph.counts().updated, 0u);
}

TEST_F(CudaStepGraph, OffItLaunchesOneByOne) {
  StepGraph graph(context(), false);
  graph.run([&] { add(1); });
  EXPECT_THAT(values.to_host(), Each(2.0f));
  EXPECT_EQ(graph.counts().plain, 1u);
  EXPECT_EQ(graph.counts().failed, 0u);
}

}  // namespace
}  // namespace aligngs::cuda
