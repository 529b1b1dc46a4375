#include "edit/contents.h"

#include <gmock/gmock.h>

#include "edit/testing/small_room.h"

namespace aligngs {
namespace {

constexpr int kVase = 135, kLamp = 36;  // ADE20K class numbers

/// The small room with a vase on the box, and a lamp beside it that is as high.
class Contents : public testing::Test {
 protected:
  Contents() {
    room_ = small_room::make(pool_);
    GaussianModel model = room_.gaussians.model;
    TriangleMesh mesh;
    small_room::add_box(model, mesh, {-0.1f, -0.6f, 0.3f}, {0.1f, -0.4f, 0.5f}, {0.9f, 0.9f, 0.9f}, kVase);
    small_room::add_box(model, mesh, {0.3f, -0.6f, 0.3f}, {0.5f, 0, 0.5f}, {0.2f, 0.2f, 0.2f}, kLamp);
    room_.gaussians = label_objects(std::move(model), room_.labels, small_room::kExtent, pool_);
  }
  std::vector<uint8_t> rows_of(int label) const {
    std::vector<uint8_t> rows;
    for (const uint16_t l : room_.gaussians.labels.label) rows.push_back(l == label);
    return rows;
  }
  std::vector<int> labels_on(int label) const {
    std::vector<int> out;
    for (const Instance& o : contents_of(room_.gaussians, rows_of(label), room_.labels, {0, -1, 0}))
      out.push_back(o.label);
    return out;
  }
  ThreadPool pool_{2};
  EditableRoom room_;
};

TEST_F(Contents, AVaseStandsOnTheBox) { EXPECT_THAT(labels_on(small_room::kBox), testing::ElementsAre(kVase)); }

TEST_F(Contents, AVaseStandsOnABoxWhoseTopNoPhotoShows) {
  LabelledGaussians& room = room_.gaussians;
  for (uint32_t i = 0; i < room.model.size(); ++i) {  // the top is at 40 cm
    if (room.labels.label[i] == small_room::kBox && room.model.positions[3 * i + 1] < -0.39f)
      room.model.opacity_logits[i] = -5;
  }
  EXPECT_THAT(labels_on(small_room::kBox), testing::Contains(kVase));
  EXPECT_THAT(labels_on(small_room::kBox), testing::Not(testing::Contains(kLamp)));
}

TEST_F(Contents, AWindowRestsOnNothing) {
  for (uint16_t& label : room_.gaussians.labels.label) {
    if (label == kVase) label = static_cast<uint16_t>(room_.labels.find("windowpane"));
  }
  EXPECT_THAT(labels_on(small_room::kBox), testing::IsEmpty());
}

TEST_F(Contents, NothingStandsOnTheVase) { EXPECT_THAT(labels_on(kVase), testing::IsEmpty()); }

/// A bed's front and head, 60 cm apart, with a blanket between them whose edge hangs down. Nobody saw the mattress.
TEST_F(Contents, ABlanketBetweenThePartsOfABedIsOnIt) {
  constexpr int kBed = 7, kBlanket = 131;
  GaussianModel model = small_room::make(pool_).gaussians.model;
  TriangleMesh mesh;
  small_room::add_box(model, mesh, {-0.8f, -0.4f, -1.1f}, {-0.4f, 0, -1.0f}, {0.9f, 0.9f, 0.9f}, kBed);
  small_room::add_box(model, mesh, {-0.8f, -0.6f, -0.4f}, {-0.4f, 0, -0.3f}, {0.9f, 0.9f, 0.9f}, kBed);
  small_room::add_box(model, mesh, {-0.8f, -0.44f, -1.0f}, {-0.4f, -0.4f, -0.4f}, {0.2f, 0.9f, 0.2f}, kBlanket);
  small_room::add_box(model, mesh, {-0.82f, -0.44f, -1.0f}, {-0.8f, -0.15f, -0.4f}, {0.2f, 0.9f, 0.2f}, kBlanket);
  room_.gaussians = label_objects(std::move(model), room_.labels, small_room::kExtent, pool_);
  EXPECT_THAT(labels_on(kBed), testing::ElementsAre(kBlanket));
}

TEST_F(Contents, TheirRowsAreAdded) {
  std::vector<uint8_t> rows = rows_of(small_room::kBox);
  const std::vector<uint8_t> vase = rows_of(kVase);
  select_objects(room_.gaussians, contents_of(room_.gaussians, rows, room_.labels, {0, -1, 0}), rows);
  for (size_t i = 0; i < vase.size(); ++i) {
    if (vase[i]) {
      EXPECT_TRUE(rows[i]);
    }
  }
}

}  // namespace
}  // namespace aligngs
