#include "serve/seen_gaussians.h"

#include <gtest/gtest.h>

#include <random>

#include "engine/engine.h"
#include "scene/camera_path.h"

namespace aligngs {
namespace {

/// Gaussians all around the origin, many of them faint.
GaussianModel cloud(size_t count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> number(-1, 1);
  GaussianModel model;
  model.sh_degree = 1;
  model.resize(count);
  for (float& v : model.positions) v = 3 * number(random);
  for (float& v : model.log_scales) v = -2.5f + number(random);
  for (float& v : model.rotations) v = number(random);
  for (float& v : model.opacity_logits) v = 8 * number(random);
  for (float& v : model.sh) v = number(random);
  return model;
}

TEST(SeenGaussians, MakeTheSamePicture) {
  const GaussianModel model = cloud(2000);
  const Camera camera = camera_of({0, {0.5, 0.2, -2}, {0, 0, 1}, 50}, {0, -1, 0}, 96, 64);
  const GaussianModel seen = seen_gaussians(model, camera);
  EXPECT_LT(seen.size(), model.size() / 2);
  EXPECT_EQ(seen.sh.size(), seen.size() * 3 * kShCoefficients);
  RenderOptions options;
  options.geometry = false;
  const auto picture = [&](const GaussianModel& of) {
    const auto engine = make_cpu_engine(1);
    engine->load(of);
    return engine->render(camera, options).color.data;
  };
  EXPECT_EQ(picture(seen), picture(model));
}

}  // namespace
}  // namespace aligngs
