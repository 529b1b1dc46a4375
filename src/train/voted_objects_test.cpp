// The slope of the small scene as one chair, which two photos show as two.
#include "train/voted_objects.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "scene/segment_file.h"
#include "scene/testing/scene_folder.h"
#include "train/config_file.h"

namespace aligngs {
namespace {

using namespace test_scene;

constexpr uint16_t kChairLabel = 2;
constexpr int kSide = 30;          // Gaussians
constexpr double kBorderX = 0.05;  // world: photos put the border between the chairs there

/// Gaussians on the slope, from x = -0.4 to 0.5 and y = -0.3 to 0.3.
GaussianModel slope() {
  GaussianModel model;
  model.resize(kSide * kSide);
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      const size_t g = static_cast<size_t>(j * kSide + i);
      const double x = -0.4 + 0.9 * (i + 0.5) / kSide, y = -0.3 + 0.6 * (j + 0.5) / kSide;
      const double p[3] = {x, y, 2 + 0.5 * x};
      for (size_t a = 0; a < 3; ++a) {
        model.positions[3 * g + a] = static_cast<float>(p[a]);
        model.log_scales[3 * g + a] = std::log(0.012f);
      }
      model.rotations[4 * g] = 1;
      model.opacity_logits[g] = 3;
    }
  }
  return model;
}

/// The pixels of the slope left and right of the border are two chairs.
void write_two_chairs(const fs::path& folder, const std::string& view, double camera_x) {
  fs::create_directories(folder / "segments");
  const Camera camera = camera_at(camera_x);
  SegmentMap map{kWidth, kHeight, {}, {{kChairLabel, 0}, {kChairLabel, 1}}};
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double depth = static_cast<double>(surface_depth(camera, x + 0.5, y + 0.5));
      map.of_pixel.push_back(camera.unproject(x + 0.5, y + 0.5, depth).x < kBorderX ? 0 : 1);
    }
  }
  write_segments(folder / "segments" / (view + ".png"), map);
}

class VotedObjects : public testing::Test {
 protected:
  fs::path scene_with_segments() const {
    const fs::path folder = write_scene();
    write_two_chairs(folder, "v0", 0);
    write_two_chairs(folder, "v1", 0.1);
    return folder;
  }
  std::vector<Instance> objects(const fs::path& folder, bool votes, int threads = 2) {
    ThreadPool pool(threads);
    TrainConfig config = resolve_config({});
    config.semantic.object_votes = votes;
    labels_ = {};
    labels_.label.assign(kSide * kSide, kChairLabel);
    labels_.confidence.assign(kSide * kSide, 255);
    return number_objects(slope(), open_scene(folder), config, labels_, pool);
  }

  GaussianLabels labels_;
};

TEST_F(VotedObjects, AreTwoWherePhotosShowTwo) {
  const std::vector<Instance> found = objects(scene_with_segments(), true);
  ASSERT_EQ(found.size(), 2u);
  const float left = std::min(found[0].high.x, found[1].high.x);
  EXPECT_NEAR(left, kBorderX, 0.06);  // a pixel is 5 cm wide there
}

TEST_F(VotedObjects, AreOneWithoutSegmentsOrVotes) {
  EXPECT_EQ(objects(write_scene(), true).size(), 1u);
  EXPECT_EQ(objects(scene_with_segments(), false).size(), 1u);
}

TEST_F(VotedObjects, AreTheSameForAnyNumberOfThreads) {
  const fs::path folder = scene_with_segments();
  objects(folder, true, 1);
  const std::vector<uint16_t> one = labels_.instance;
  objects(folder, true, 3);
  EXPECT_EQ(labels_.instance, one);
}

TEST_F(VotedObjects, ADamagedFileOfSegmentsIsNamed) {
  const fs::path folder = scene_with_segments();
  const Scene scene = open_scene(folder);
  write_text(folder / "segments" / "v1.png", "no picture");
  ThreadPool pool(1);
  TrainConfig config = resolve_config({});
  labels_.label.assign(kSide * kSide, kChairLabel);
  try {
    number_objects(slope(), scene, config, labels_, pool);
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.details().path.filename(), "v1.png");
  }
}

}  // namespace
}  // namespace aligngs
