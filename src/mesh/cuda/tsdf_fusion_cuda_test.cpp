// Fusion on a device: the same field as on the CPU, to the last bit.
#include "mesh/cuda/tsdf_fusion.h"

#include <cstring>

#include "core/error.h"
#include "device/testing/device.h"
#include "mesh/fusion.h"
#include "mesh/testing/analytic_scenes.h"
#include "mesh/tsdf_volume.h"

namespace aligngs {
namespace {

ThreadPool& pool() {
  static ThreadPool instance(2);
  return instance;
}

/// Views of a ball with colours, weights and slopes that differ from pixel to pixel; the last one only refines.
struct Views {
  std::vector<FusionFrame> frames = test::ball_views(0.5);
  std::vector<ImageF> colors, weights, slopes;
  std::vector<TsdfView> views;

  Views() {
    frames.resize(3);
    for (const FusionFrame& f : frames) {
      ImageF color(f.camera.width, f.camera.height, 3), weight(f.camera.width, f.camera.height, 1);
      for (size_t i = 0; i < color.data.size(); ++i) color.data[i] = float(i * 37 % 101) / 100;
      for (size_t i = 0; i < weight.data.size(); ++i) weight.data[i] = float(i * 17 % 13) / 7;
      ImageF slope(f.camera.width, f.camera.height, 1);
      for (size_t i = 0; i < slope.data.size(); ++i) slope.data[i] = 0.2f + float(i * 11 % 7) / 8;
      slopes.push_back(slope);
      colors.push_back(color);
      weights.push_back(weight);
    }
    for (size_t i = 0; i < frames.size(); ++i) {
      views.push_back({&frames[i].camera, &frames[i].depth, i == 1 ? nullptr : &colors[i], &weights[i],
                       i == 1 ? nullptr : &slopes[i], i + 1 == frames.size()});
    }
  }
  TsdfVolume volume() const {
    TsdfOptions options;
    options.voxel = 0.06;
    options.truncation = 0.18;
    TsdfVolume v(options);
    for (size_t i = 0; i + 1 < views.size(); ++i) v.reserve(views[i], pool());
    v.allocate();
    return v;
  }
};

void expect_same(const TsdfVolume& a, const TsdfVolume& b) {
  ASSERT_EQ(a.blocks(), b.blocks());
  size_t observed = 0, coloured = 0;
  for (size_t i = 0; i < a.blocks(); ++i) {
    ASSERT_EQ(0, std::memcmp(a.voxels(i), b.voxels(i), sizeof(Voxel) * kBlockVoxels)) << "block " << i;
    for (int v = 0; v < kBlockVoxels; ++v) {
      observed += a.voxels(i)[v].weight > 0;
      coloured += a.voxels(i)[v].color_weight > 0;
    }
  }
  EXPECT_GT(observed, 1000u);
  EXPECT_GT(coloured, 100u);
}

using CudaFusion = cuda::DeviceTest;

TEST_F(CudaFusion, TheFieldIsThatOfTheCpuBitForBit) {
  const Views views;
  TsdfVolume expected = views.volume(), found = views.volume();
  for (const TsdfView& v : views.views) expected.integrate(v, pool());
  const auto device = make_cuda_tsdf_device(context().device());
  found.integrate(views.views, *device);
  expect_same(expected, found);
}

TEST_F(CudaFusion, AVolumeLargerThanTheDeviceIsFusedInParts) {
  const Views views;
  TsdfVolume expected = views.volume(), found = views.volume();
  for (const TsdfView& v : views.views) expected.integrate(v, pool());
  const uint64_t maps = 6 * sizeof(float) * views.weights[0].data.size();
  const auto device =
      make_cuda_tsdf_device(context().device(), maps + (found.blocks() / 3) * (sizeof(Voxel) * kBlockVoxels + 64));
  found.integrate(views.views, *device);
  expect_same(expected, found);
}

TEST_F(CudaFusion, ADeviceWithoutRoomForOneViewIsAnError) {
  const Views views;
  TsdfVolume volume = views.volume();
  const auto device = make_cuda_tsdf_device(context().device(), 1024);
  try {
    volume.integrate(views.views, *device);
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kResources);
  }
}

TEST_F(CudaFusion, NothingSeenLeavesTheFieldAsItWas) {
  Views views;
  TsdfVolume volume = views.volume();
  for (ImageF& w : views.weights) std::fill(w.data.begin(), w.data.end(), 0.0f);
  const auto device = make_cuda_tsdf_device(context().device());
  volume.integrate(views.views, *device);
  for (size_t b = 0; b < volume.blocks(); ++b) {
    for (int v = 0; v < kBlockVoxels; ++v) ASSERT_EQ(volume.voxels(b)[v].weight, 0);
  }
}

TEST_F(CudaFusion, TheMeshOfARoomIsThatOfTheCpu) {
  std::vector<FusionFrame> frames = test::room_views({1, 0.8, 0.9}, 3);
  FusionOptions options = test::fusion_options();
  options.metric = true;
  options.voxel = 0.06;
  options.truncation = 0.12;
  const TriangleMesh expected = fuse_depth(frames, options, pool()).mesh;
  options.device = make_cuda_tsdf_device(context().device());
  const TriangleMesh found = fuse_depth(frames, options, pool()).mesh;
  ASSERT_GT(expected.vertices.size(), 100u);
  ASSERT_EQ(found.vertices.size(), expected.vertices.size());
  EXPECT_EQ(found.triangles, expected.triangles);
  for (size_t i = 0; i < found.vertices.size(); ++i) ASSERT_EQ(norm(found.vertices[i] - expected.vertices[i]), 0) << i;
}

}  // namespace
}  // namespace aligngs
