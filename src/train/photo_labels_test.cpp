// A wall with a small thing on it, seen by four cameras side by side.
#include "train/photo_labels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/half.h"
#include "scene/semantic_target.h"

namespace aligngs {
namespace {

constexpr int kWidth = 64, kHeight = 48, kClasses = 4, kPhotos = 4;
constexpr uint16_t kWall = 0, kLamp = 2;
constexpr float kSpacing = 0.05f, kDepth = 2;  // metres; one Gaussian a pixel
constexpr double kFocal = 40;                  // pixels

/// Columns and rows of the thing, of the wall's Gaussians.
constexpr int kLow = 28, kHigh = 36;
bool on_thing(int column, int row) { return column >= kLow && column < kHigh && row >= 20 && row < 28; }

GaussianModel wall() {
  GaussianModel model;
  model.semantic_channels = kClasses;
  model.resize(kWidth * kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const size_t i = static_cast<size_t>(y * kWidth + x);
      const float p[3] = {kSpacing * (static_cast<float>(x - kWidth / 2) + 0.5f),
                          kSpacing * (static_cast<float>(y - kHeight / 2) + 0.5f), kDepth};
      const float s[3] = {0.5f * kSpacing, 0.5f * kSpacing, 0.05f * kSpacing};
      for (size_t a = 0; a < 3; ++a) {
        model.positions[3 * i + a] = p[a];
        model.log_scales[3 * i + a] = std::log(s[a]);
      }
      model.rotations[4 * i] = 1;
      model.opacity_logits[i] = 4;
      // A thing of its own colour, so that smoothing ends at its outline.
      if (on_thing(x, y)) model.sh[3 * kShCoefficients * i] = 2;
    }
  }
  return model;
}

/// A photo from 4 k spacings to the right, in which the thing is called `thing` with probability 0.8 and the rest wall.
TrainingView photo(int k, uint16_t thing) {
  TrainingView view;
  Camera& camera = view.data.camera;
  camera.width = kWidth;
  camera.height = kHeight;
  camera.fx = camera.fy = kFocal;
  camera.cx = kWidth / 2;
  camera.cy = kHeight / 2;
  camera.world_to_camera.translation = {-4.0 * k * static_cast<double>(kSpacing), 0, 0};
  view.data.color = ImageF(kWidth, kHeight, 3);
  SemanticTarget& t = view.data.semantics;
  t.channels = kClasses;
  t.width = kWidth;
  t.height = kHeight;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const uint16_t label = on_thing(x + 4 * k, y) ? thing : kWall;
      for (int c = 0; c < kClasses; ++c)
        t.probabilities.push_back(float_to_half(c == label                                 ? 0.8f
                                                : c == kWall || (label == kWall && c == 1) ? 0.2f
                                                                                           : 0.0f));
    }
  }
  t.confidence.assign(static_cast<size_t>(kWidth * kHeight), 1.0f);
  normalise_target(t);
  return view;
}

/// `lamps` of the four photos see a lamp.
PhotoLabelInputs photos(int lamps) {
  PhotoLabelInputs in;
  for (int k = 0; k < kPhotos; ++k) {
    in.views.push_back(photo(k, k < lamps ? kLamp : kWall));
    in.near_planes.push_back(0.1f);
  }
  in.extent = 2;
  return in;
}

uint16_t label_of(const GaussianModel& model, int column, int row) {
  const float* s = &model.semantics[static_cast<size_t>(row * kWidth + column) * kClasses];
  return static_cast<uint16_t>(std::max_element(s, s + kClasses) - s);
}

TEST(PhotoLabels, ASmallThingSeenBySeveralPhotosSurvives) {
  ThreadPool pool(2);
  GaussianModel model = wall();
  const PhotoLabelReport report = vote_label_rows(model, photos(3), pool);
  EXPECT_GT(report.regions, 0u);
  EXPECT_EQ(label_of(model, 32, 24), kLamp);
  EXPECT_EQ(label_of(model, 29, 21), kLamp);
  EXPECT_EQ(label_of(model, 24, 24), kWall);
  EXPECT_EQ(label_of(model, 32, 16), kWall);
}

TEST(PhotoLabels, OnePhotosMistakeDoesNot) {
  ThreadPool pool(2);
  GaussianModel model = wall();
  vote_label_rows(model, photos(1), pool);
  EXPECT_EQ(label_of(model, 32, 24), kWall);
}

TEST(PhotoLabels, AreTheSameForAnyNumberOfThreads) {
  std::vector<float> first;
  for (const int threads : {1, 3}) {
    ThreadPool pool(threads);
    GaussianModel model = wall();
    vote_label_rows(model, photos(2), pool);
    if (first.empty()) first = model.semantics;
    EXPECT_EQ(model.semantics, first);
  }
}

TEST(PhotoLabels, GaussiansThatNoPhotoShowsKeepTheirRows) {
  ThreadPool pool(1);
  GaussianModel model = wall();
  const size_t last = model.size() - 1;  // behind the cameras
  model.positions[3 * last + 2] = -5;
  model.semantics[last * kClasses + 3] = 7;
  vote_label_rows(model, photos(3), pool);
  EXPECT_EQ(model.semantics[last * kClasses + 3], 7);
}

TEST(PhotoLabels, WithoutPhotosOrSemanticsNothingHappens) {
  ThreadPool pool(1);
  GaussianModel model = wall();
  const std::vector<float> before = model.semantics;
  EXPECT_EQ(vote_label_rows(model, {}, pool).regions, 0u);
  EXPECT_EQ(model.semantics, before);
  GaussianModel none;
  EXPECT_EQ(vote_label_rows(none, photos(3), pool).regions, 0u);
}

}  // namespace
}  // namespace aligngs
