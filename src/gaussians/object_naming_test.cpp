#include "gaussians/object_naming.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "gaussians/point_tree.h"
#include "gaussians/soft_labels.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

enum : uint16_t { kWall, kBlind, kCurtain, kRadiator, kLamp, kNamedClasses };

/// Adds a region called `label`: what share of its votes and how many photos each class has.
struct Said {
  uint16_t label;
  double share;
  uint16_t photos;
};
void add_region(RegionEvidence& e, uint16_t label, double area, const std::vector<Said>& said) {
  e.classes = kNamedClasses;
  e.label.push_back(label);
  e.area.push_back(area);
  e.share.resize(e.share.size() + kNamedClasses, 0.0);
  e.photos.resize(e.photos.size() + kNamedClasses, 0);
  for (const Said& s : said) {
    e.share[e.share.size() - kNamedClasses + s.label] = s.share;
    e.photos[e.photos.size() - kNamedClasses + s.label] = s.photos;
  }
}

/// Both are called blind by most photos. As blinds they promise 0.6 in one class; as what they might be, 0.4 and 0.35
/// in two.
TEST(NameRegions, OneClassDoesNotTakeTheRegionsOfTwo) {
  RegionEvidence e;
  add_region(e, kBlind, 100, {{kBlind, 0.6, 5}, {kCurtain, 0.4, 2}});
  add_region(e, kBlind, 130, {{kBlind, 0.6, 6}, {kRadiator, 0.35, 3}});
  EXPECT_EQ(name_regions(e), (std::vector<uint16_t>{kCurtain, kRadiator}));
}

TEST(NameRegions, ASmallThingThatSeveralPhotosAgreeOnKeepsItsName) {
  RegionEvidence e;
  add_region(e, kWall, 10000, {{kWall, 0.95, 8}});
  add_region(e, kWall, 50, {{kWall, 0.55, 4}, {kLamp, 0.45, 3}});
  EXPECT_EQ(name_regions(e), (std::vector<uint16_t>{kWall, kLamp}));
}

TEST(NameRegions, OnePhotosMistakeIsNoName) {
  RegionEvidence e;
  add_region(e, kWall, 10000, {{kWall, 0.95, 8}});
  add_region(e, kWall, 50, {{kWall, 0.55, 4}, {kLamp, 0.45, 1}});
  EXPECT_EQ(name_regions(e), (std::vector<uint16_t>{kWall, kWall}));
}

TEST(NameRegions, AFewVotesAreNoName) {
  RegionEvidence e;
  add_region(e, kWall, 10000, {{kWall, 0.95, 8}});
  add_region(e, kWall, 50, {{kWall, 0.8, 4}, {kLamp, 0.2, 3}});
  EXPECT_EQ(name_regions(e)[1], kWall);
}

/// The lamp elsewhere would lose more by a second, doubtful one than the wall by a hundredth of itself.
TEST(NameRegions, AClassThatHasItsRegionTakesNoDoubtfulOne) {
  RegionEvidence e;
  add_region(e, kWall, 1000, {{kWall, 0.95, 8}});
  add_region(e, kLamp, 50, {{kLamp, 0.95, 8}});
  add_region(e, kWall, 50, {{kWall, 0.7, 4}, {kLamp, 0.3, 3}});
  EXPECT_EQ(name_regions(e), (std::vector<uint16_t>{kWall, kLamp, kWall}));
}

TEST(NameRegions, WithoutRegionsOrLabelsNothingHappens) {
  EXPECT_TRUE(name_regions({}).empty());
  RegionEvidence e;
  add_region(e, kNoLabel, 50, {{kLamp, 0.9, 8}});
  EXPECT_EQ(name_regions(e), (std::vector<uint16_t>{kNoLabel}));
}

/// A lamp of ten Gaussians: its photos agree on the middle, and on its rim 0.4 of the votes are for it.
OutlineEvidence lamp_on_a_wall(uint8_t allowed) {
  OutlineEvidence e;
  e.classes = kNamedClasses;
  for (size_t i = 0; i < 1000; ++i) {
    const bool middle = i < 4, rim = i >= 4 && i < 10;
    e.area.push_back(1);
    e.soft.label.resize(SoftLabels::kTop * (i + 1), kNoLabel);
    e.soft.probability.resize(SoftLabels::kTop * (i + 1), 0.0f);
    e.allowed.resize(SoftLabels::kTop * (i + 1), 1);
    const size_t k = SoftLabels::kTop * i;
    e.soft.label[k] = middle ? kLamp : kWall;
    e.soft.probability[k] = middle ? 0.8f : rim ? 0.6f : 1.0f;
    if (!middle && !rim) continue;
    e.soft.label[k + 1] = middle ? kWall : kLamp;
    e.soft.probability[k + 1] = middle ? 0.2f : 0.4f;
    e.allowed[k + 1] = allowed;
  }
  return e;
}

TEST(LabelOutlines, ASmallThingKeepsItsRim) {
  const std::vector<uint16_t> label = label_outlines(lamp_on_a_wall(1));
  EXPECT_EQ(std::count(label.begin(), label.end(), uint16_t(kLamp)), 10);
}

TEST(LabelOutlines, WhatIsNotAllowedIsLeft) {
  const std::vector<uint16_t> label = label_outlines(lamp_on_a_wall(0));
  EXPECT_EQ(std::count(label.begin(), label.end(), uint16_t(kLamp)), 4);
}

/// Gaussians on a line, 1 apart but where a gap is asked for.
LabelRegions regions_of(const std::vector<uint16_t>& label, const std::vector<float>& positions,
                        const std::vector<float>& opacity_logits) {
  GaussianModel model;
  model.resize(label.size());
  for (size_t i = 0; i < label.size(); ++i) model.positions[3 * i] = positions[i];
  model.opacity_logits = opacity_logits;
  ThreadPool pool(2);
  return connected_regions(label, model, neighbour_graph(positions_of(model), 2, pool), 1.5);
}

TEST(ConnectedRegions, EndAtGapsOtherClassesAndFaintGaussians) {
  const LabelRegions r = regions_of({kWall, kWall, kWall, kLamp, kLamp, kLamp, kLamp, kNoLabel},
                                    {0, 1, 5, 6, 7, 8, 9, 10}, {3, 3, 3, 3, 3, -9, 3, 3});
  EXPECT_EQ(r.of_gaussian, (std::vector<uint32_t>{0, 0, 1, 2, 2, 3, 4, 5}));
  EXPECT_EQ(r.label, (std::vector<uint16_t>{kWall, kWall, kLamp, kLamp, kLamp, kNoLabel}));
  EXPECT_EQ(r.count, 6u);
}

}  // namespace
}  // namespace aligngs
