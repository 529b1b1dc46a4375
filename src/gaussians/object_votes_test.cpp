// A slab of one class that photos show as one or two things.
#include "gaussians/object_votes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

constexpr uint16_t kChair = 19, kSofa = 23;
constexpr int kColumns = 40, kRows = 12;
constexpr float kPitch = 0.02f;  // metres
constexpr double kExtent = 3;

/// `gap`: metres between the left and the right half.
GaussianModel slab(float gap = 0) {
  GaussianModel model;
  model.resize(kColumns * kRows);
  for (int y = 0; y < kRows; ++y) {
    for (int x = 0; x < kColumns; ++x) {
      const size_t i = static_cast<size_t>(y * kColumns + x);
      model.positions[3 * i] = kPitch * static_cast<float>(x) + (x < kColumns / 2 ? 0 : gap);
      model.positions[3 * i + 1] = kPitch * static_cast<float>(y);
      model.opacity_logits[i] = 4;
    }
  }
  return model;
}

GaussianLabels chairs() {
  GaussianLabels labels;
  labels.label.assign(kColumns * kRows, kChair);
  labels.confidence.assign(kColumns * kRows, 255);
  return labels;
}

/// A photo in which columns below `border` are its first segment, and the others its second.
PhotoSegments photo(int border, uint16_t first = kChair, uint16_t second = kChair) {
  PhotoSegments out;
  out.segments = {{first, 0}, {second, 1}};
  for (uint32_t i = 0; i < kColumns * kRows; ++i)
    out.seen.push_back({i, static_cast<uint16_t>(static_cast<int>(i) % kColumns < border ? 0 : 1), 3});
  return out;
}

const PhotoSegments kWhole = photo(kColumns), kHalves = photo(kColumns / 2);

class ObjectVotes : public testing::Test {
 protected:
  /// Objects found; their numbers are in labels_.
  size_t count(const GaussianModel& model, const std::vector<PhotoSegments>& photos) {
    labels_ = chairs();
    return vote_instances(model, labels_, photos, kExtent, {}, {}, pool_).size();
  }
  uint16_t number(int column, int row) const { return labels_.instance[static_cast<size_t>(row * kColumns + column)]; }

  ThreadPool pool_{2};
  GaussianLabels labels_;
};

TEST_F(ObjectVotes, TouchingThingsThatPhotosTellApartAreTwo) {
  EXPECT_EQ(count(slab(), {kHalves, kHalves, kHalves}), 2u);
  EXPECT_NE(number(5, 6), number(35, 6));
  EXPECT_EQ(number(5, 2), number(18, 10));
}

TEST_F(ObjectVotes, MostPhotosDecide) {
  EXPECT_EQ(count(slab(), {kHalves, kWhole, kHalves, kHalves}), 2u);
  EXPECT_EQ(count(slab(), {kWhole, kHalves, kWhole, kWhole}), 1u);
}

TEST_F(ObjectVotes, PiecesApartThatPhotosShowAsOneThingAreOne) {
  const GaussianModel model = slab(0.5f);
  EXPECT_EQ(count(model, {}), 2u);
  EXPECT_EQ(count(model, {kWhole, kWhole, kWhole}), 1u);
}

TEST_F(ObjectVotes, OnePhotoIsNotEnoughToJoinWhatIsApart) { EXPECT_EQ(count(slab(0.5f), {kWhole}), 2u); }

TEST_F(ObjectVotes, SegmentsOfDifferentClassesSayNothing) {
  const PhotoSegments sofa_and_chair = photo(kColumns / 2, kChair, kSofa);
  EXPECT_EQ(count(slab(), {sofa_and_chair, sofa_and_chair}), 1u);
}

TEST_F(ObjectVotes, SegmentsOfStuffSayNothing) {
  PhotoSegments stuff = kHalves;
  stuff.segments = {{kChair, Segment::kStuff}, {kChair, Segment::kStuff}};
  EXPECT_EQ(count(slab(), {stuff, stuff}), 1u);
}

TEST_F(ObjectVotes, AFewPixelsInASegmentDoNotMakeAPiecePartOfIt) {
  // the left piece is a chair; of the right one most pixels lie in no segment, and some in that of the chair
  PhotoSegments spilled = kWhole;
  for (SegmentSighting& s : spilled.seen) {
    if (static_cast<int>(s.gaussian) % kColumns >= kColumns / 2 + 4) s.segment = SegmentMap::kNone;
  }
  EXPECT_EQ(count(slab(0.5f), {spilled, spilled, spilled, spilled}), 2u);
}

TEST_F(ObjectVotes, WithoutSegmentsTheyAreThoseOfConnections) {
  const GaussianModel model = slab(0.5f);
  PhotoSegments nothing;
  count(model, {nothing, nothing});
  GaussianLabels connected = chairs();
  find_instances(model, connected, kExtent, {}, pool_);
  EXPECT_EQ(labels_.instance, connected.instance);
}

TEST_F(ObjectVotes, SegmentsWithoutPixelsOfTheClassChangeNothing) {
  PhotoSegments elsewhere;
  elsewhere.segments = {{kSofa, 0}};
  EXPECT_EQ(count(slab(), {elsewhere}), 1u);
}

TEST_F(ObjectVotes, OfNoGaussiansAreNone) {
  labels_ = {};
  EXPECT_TRUE(vote_instances({}, labels_, {kHalves}, kExtent, {}, {}, pool_).empty());
}

TEST_F(ObjectVotes, EveryGaussianOfATornSlabBelongsToAnObject) {
  // the photos put the border at three places: what lies between goes to either side, and nothing is left over
  count(slab(), {photo(18), photo(20), photo(22)});
  EXPECT_EQ(std::count(labels_.instance.begin(), labels_.instance.end(), 0), 0);
  EXPECT_EQ(std::set<uint16_t>(labels_.instance.begin(), labels_.instance.end()), (std::set<uint16_t>{1, 2}));
}

TEST_F(ObjectVotes, AreTheSameForAnyNumberOfThreads) {
  std::vector<uint16_t> first;
  for (const int threads : {1, 3}) {
    ThreadPool pool(threads);
    GaussianLabels labels = chairs();
    vote_instances(slab(), labels, {photo(18), kHalves, photo(23), kWhole}, kExtent, {}, {}, pool);
    if (first.empty()) first = labels.instance;
    EXPECT_EQ(labels.instance, first);
  }
}

}  // namespace
}  // namespace aligngs
