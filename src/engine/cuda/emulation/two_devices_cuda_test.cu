// Everything of a context happens on its device, whichever is current and whichever thread calls.
#include <gtest/gtest.h>

#include <functional>
#include <thread>
#include <vector>

#include "core/error.h"
#include "device/device_calls.h"
#include "device/emulation/emulated_devices.h"
#include "device/launch.h"
#include "device/sort_scan.h"
#include "engine/cuda/make_engine.h"
#include "engine/testing/scenes.h"
#include "nn/cpu/matrix_backend.h"
#include "nn/cuda/network_device.h"

namespace aligngs::cuda {
namespace {

class TwoDevices : public testing::Test {
 protected:
  ScopedEmulatedDevices devices_{2};
};

/// Runs `body` on a thread of its own, whose current device is the first as on every new thread.
void on_new_thread(const std::function<void()>& body) {
  std::string failure;
  std::thread thread([&] {
    try {
      body();
    } catch (const std::exception& e) {
      failure = e.what();
    }
  });
  thread.join();
  EXPECT_EQ(failure, "");
}

__global__ void add_one(DeviceSpan<uint32_t> values) { values[threadIdx.x] += 1; }

/// Allocates, copies, launches, sorts and scans.
std::vector<uint32_t> worked_on(DeviceContext& context) {
  DeviceArray<uint32_t> keys, values, sorted(context, 32, "test"), order(context, 32, "test");
  std::vector<uint32_t> numbers(32);
  for (uint32_t i = 0; i < 32; ++i) numbers[i] = 31 - i;
  keys.assign(context, numbers, "test");
  values.assign(context, numbers, "test");
  launch(context, "add_one", add_one, {dim3(1), dim3(32)}, values.span());
  DeviceArena arena(context);
  sort_pairs(arena, keys.span(), values.span(), sorted.span(), order.span(), 8);
  exclusive_scan(arena, order.span(), order.span());
  return order.to_host();
}

TEST_F(TwoDevices, ListingThemLeavesTheCurrentOneAsItWas) {
  for (const int device : {0, 1}) {
    calls::set_device(device);
    EXPECT_EQ(list_cuda_devices().devices.size(), 2u);
    EXPECT_EQ(calls::current_device(), device);
  }
}

TEST_F(TwoDevices, AContextWorksOnItsDeviceFromAnyThread) {
  DeviceContext first(0), second(1);
  const std::vector<uint32_t> expected = worked_on(first);
  EXPECT_EQ(expected[31], 31u * 32u / 2u);
  on_new_thread([&] { EXPECT_EQ(worked_on(second), expected); });
  EXPECT_EQ(worked_on(second), expected);
  EXPECT_EQ(worked_on(first), expected);
}

TEST_F(TwoDevices, MemoryOfContextsInTurnIsWhereItBelongs) {
  DeviceContext first(0), second(1);
  const uint64_t here = emulated_bytes_on(0), there = emulated_bytes_on(1);
  DeviceArray<float> a(first, 100, "test"), b(second, 1000, "test"), c(first, 10, "test");
  EXPECT_EQ(emulated_bytes_on(0) - here, 440u);
  EXPECT_EQ(emulated_bytes_on(1) - there, 4000u);
}

TEST_F(TwoDevices, AnEngineKeepsToItsDevice) {
  using namespace cpu::testing_scene;
  cpu::testing_scene::RandomSceneOptions o;
  o.width = 20;
  o.height = 16;
  o.gaussians = 10;
  for (const int device : {0, 1}) {
    const uint64_t other = emulated_bytes_on(1 - device), own = emulated_bytes_on(device);
    const std::unique_ptr<Engine> engine = make_cuda_engine(device, 0, 1);
    (void)list_cuda_devices();
    on_new_thread([&] {
      engine->load(make_model(o));
      engine->set_training_views({make_view(o)});
      engine->step(make_request());
      RestructurePlan plan;
      plan.rows.resize(12);
      engine->restructure(plan);
    });
    engine->render(make_camera(20, 16), {});
    EXPECT_EQ(emulated_bytes_on(1 - device), other);
    EXPECT_GT(emulated_bytes_on(device), own);
    EXPECT_EQ(engine->device_name(), "cuda:" + std::to_string(device) + ", emulated CUDA device");
  }
}

TEST_F(TwoDevices, NetworksKeepToTheirDevice) {
  const uint64_t other = emulated_bytes_on(0);
  const auto device = make_cuda_network_device(1);
  on_new_thread([&] {
    const std::vector<float> weights(64, 0.5f), x(8, 2.0f);
    const auto matrix = device->pack(weights.data(), 8, 8, nn::Precision::kFloat32);
    std::vector<float> y(8);
    nn::Scratch scratch;
    matrix->multiply_operands(x.data(), 1, y.data(), scratch);
    EXPECT_EQ(y, std::vector<float>(8, 8.0f));
  });
  EXPECT_EQ(emulated_bytes_on(0), other);
}

TEST_F(TwoDevices, WorkOnAStreamOfAnotherDeviceIsAnError) {
  DeviceContext second(1);
  DeviceArray<float> array(second, 1, "test");
  calls::set_device(0);
  EXPECT_THROW(calls::fill_bytes(array.span().data, 0, 4, second.stream()), Error);
  EXPECT_NO_THROW(second.fill_bytes(array.span().data, 0, 4));
}

}  // namespace
}  // namespace aligngs::cuda
