#include <gtest/gtest.h>
#include <sys/wait.h>

#include <atomic>
#include <cmath>

#include "core/edit_distance.h"
#include "core/half.h"
#include "core/random.h"
#include "core/rigid.h"
#include "core/spherical_harmonics.h"
#include "core/thread_pool.h"

namespace aligngs {
namespace {

TEST(ThreadPool, VisitsEveryIndexOnceForAnyThreadCount) {
  for (const int threads : {1, 2, 5}) {
    ThreadPool pool(threads);
    std::vector<std::atomic<int>> visits(1001);
    for (int round = 0; round < 20; ++round) {
      pool.parallel_for(visits.size(), 7, [&](size_t begin, size_t end, int worker) {
        ASSERT_LT(worker, pool.size());
        for (size_t i = begin; i < end; ++i) ++visits[i];
      });
    }
    for (const auto& v : visits) EXPECT_EQ(v.load(), 20);
  }
}

TEST(ThreadPool, RethrowsTheFirstException) {
  ThreadPool pool(3);
  EXPECT_THROW(pool.parallel_for(100, 1,
                                 [](size_t i, size_t, int) {
                                   if (i == 50) throw std::runtime_error("x");
                                 }),
               std::runtime_error);
  std::atomic<int> after{0};
  pool.parallel_for(10, 1, [&](size_t, size_t, int) { ++after; });
  EXPECT_EQ(after.load(), 10);
}

TEST(Similarity, RecoversAKnownMotion) {
  Random random(3);
  Similarity truth;
  truth.scale = 0.37;
  truth.rotation = rotation_matrix(normalized(Quaterniond{0.3, -0.5, 0.7, 0.2}));
  truth.translation = {1, -2, 3};
  std::vector<Vec3d> a, b;
  std::vector<Rigidd> cameras_a, cameras_b;
  for (int i = 0; i < 6; ++i) {
    a.push_back({random.normal(), random.normal(), random.normal()});
    b.push_back(truth * a.back());
    Rigidd pose{
        rotation_matrix(normalized(Quaterniond{random.normal(), random.normal(), random.normal(), random.normal()})),
        {random.normal(), random.normal(), random.normal()}};
    cameras_a.push_back(pose);
    cameras_b.push_back(truth.transform_world_to_camera(pose));
    // The same world point has the same image, at a depth scaled with the world.
    const Vec3d in_a = pose * a.back(), in_b = cameras_b.back() * b.back();
    EXPECT_NEAR(norm(in_a * truth.scale - in_b), 0, 1e-12);
  }
  for (const SimilarityFit& fit : {fit_similarity(a, b), fit_similarity_of_cameras(cameras_a, cameras_b)}) {
    EXPECT_TRUE(fit.well_posed);
    EXPECT_NEAR(fit.similarity.scale, 0.37, 1e-12);
    EXPECT_NEAR(rotation_angle_between_degrees(fit.similarity.rotation, truth.rotation), 0, 1e-9);
    EXPECT_NEAR(fit.rmse, 0, 1e-12);
  }
}

TEST(Similarity, SaysWhenPointsDoNotDetermineIt) {
  EXPECT_FALSE(fit_similarity({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}).well_posed);
  EXPECT_FALSE(fit_similarity({}, {}).well_posed);
}

TEST(Quaternion, RoundTripsThroughTheMatrix) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Quaterniond q = normalized(Quaterniond{random.normal(), random.normal(), random.normal(), random.normal()});
    const Mat3d r = rotation_matrix(q);
    EXPECT_NEAR(rotation_angle_between_degrees(rotation_matrix(quaternion_of(r)), r), 0, 1e-6);
    const Vec3d n = r.column(2);
    EXPECT_NEAR(norm(rotation_matrix(quaternion_from_z_to(n)) * Vec3d{0, 0, 1} - n), 0, 1e-9);
  }
}

TEST(SphericalHarmonics, GradientMatchesFiniteDifferences) {
  const Vec3d d = normalized(Vec3d{0.3, -0.6, 0.5});
  double weight[16];
  for (int k = 0; k < 16; ++k) weight[k] = 0.1 * (k + 1) * (k % 2 ? -1 : 1);
  for (int degree = 0; degree <= 3; ++degree) {
    const Vec3d g = sh_basis_gradient(degree, d, weight);
    for (int axis = 0; axis < 3; ++axis) {
      const double h = 1e-6;
      double value[2];
      for (int side = 0; side < 2; ++side) {
        Vec3d moved = d;
        moved[axis] += side ? -h : h;
        double basis[16];
        sh_basis(degree, moved, basis);
        value[side] = 0;
        for (int k = 0; k < sh_coefficient_count(degree); ++k) value[side] += weight[k] * basis[k];
      }
      EXPECT_NEAR(g[axis], (value[0] - value[1]) / (2 * h), 1e-8) << "degree " << degree << " axis " << axis;
    }
  }
}

TEST(Half, RoundTripsEveryFiniteValue) {
  for (uint32_t h = 0; h < 65536; ++h) {
    const float f = half_to_float(uint16_t(h));
    if (std::isnan(f)) continue;
    EXPECT_EQ(float_to_half(f), uint16_t(h)) << h;
  }
  EXPECT_TRUE(std::isnan(half_to_float(float_to_half(NAN))));
  EXPECT_EQ(half_to_float(float_to_half(65504.f)), 65504.f);
  EXPECT_TRUE(std::isinf(half_to_float(float_to_half(1e6f))));
  EXPECT_EQ(float_to_half(1.0f + 1.0f / 2048), float_to_half(1.0f));  // a tie goes to even
}

TEST(EditDistance, CountsLetters) {
  EXPECT_EQ(edit_distance("train", "train"), 0u);
  EXPECT_EQ(edit_distance("trian", "train"), 2u);
  EXPECT_EQ(edit_distance("", "abc"), 3u);
  EXPECT_EQ(edit_distance("sofa", "sofas"), 1u);
}

TEST(Random, RepeatsFromASavedState) {
  Random a(7);
  for (int i = 0; i < 10; ++i) a.next();
  Random b(0);
  b.set_state(a.state());
  for (int i = 0; i < 10; ++i) EXPECT_EQ(a.next(), b.next());
  double sum = 0, square = 0;
  for (int i = 0; i < 20000; ++i) {
    const double x = a.normal();
    sum += x;
    square += x * x;
  }
  EXPECT_NEAR(sum / 20000, 0, 0.03);
  EXPECT_NEAR(square / 20000, 1, 0.05);
}

}  // namespace
}  // namespace aligngs
