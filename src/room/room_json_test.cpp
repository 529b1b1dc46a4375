#include "room/room_json.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/json_text.h"
#include "room/testing/sample_room.h"

namespace aligngs {
namespace {

class RoomJson : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::remove(file_); }
  /// The field in the error of reading room.json after `change` of its document.
  template <class Change>
  std::string error_after(Change&& change) {
    nlohmann::ordered_json document = parse_ordered_json(room_json(sample_room::make()));
    change(document);
    write_file_atomically(file_, json_document(document));
    try {
      read_room(file_);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
      return error.details().field;
    }
    return "no error";
  }
  std::filesystem::path file_ = std::filesystem::path(testing::TempDir()) / "aligngs_room.json";
};

TEST_F(RoomJson, WhatIsWrittenIsRead) {
  const MeasuredRoom room = sample_room::make();
  write_room(file_, room);
  EXPECT_EQ(room_json(read_room(file_)), room_json(room));
}

TEST_F(RoomJson, TheBoxOfThePointsIsKept) {
  MeasuredRoom room = sample_room::make();
  ASSERT_FALSE(room.boxes.empty());
  room.boxes[0].shown = ShownBox{{1, 2}, 0.5, 0.25, 0.1, 0.9, 30};
  write_room(file_, room);
  const MeasuredBox box = read_room(file_).boxes[0];
  ASSERT_TRUE(box.shown);
  EXPECT_NEAR(box.shown->centre.y, 2, 1e-5);
  EXPECT_NEAR(box.shown->depth, 0.25, 1e-5);
  EXPECT_NEAR(box.shown->bottom, 0.1, 1e-5);
  EXPECT_NEAR(rescaled(read_room(file_), 2).boxes[0].shown->top, 1.8, 1e-5);
}

TEST_F(RoomJson, AScaleThatWasTakenBackLeavesTheMeasures) {
  const MeasuredRoom room = sample_room::make();
  write_room(file_, room);
  const MeasuredRoom written = read_room(file_);
  for (const double factor : {4.5e-4, 1.0 / 3, 77.7}) {
    MeasuredRoom scaled = rescaled(written, factor);
    scaled.scale_source = ScaleSource::kGiven;
    write_room(file_, scaled);
    MeasuredRoom back = rescaled(read_room(file_), 1 / factor);
    back.scale_source = written.scale_source;
    EXPECT_EQ(parse_json(room_json(back))["walls"], parse_json(room_json(written))["walls"]) << factor;
    EXPECT_EQ(parse_json(room_json(back))["measures"], parse_json(room_json(written))["measures"]) << factor;
  }
}

TEST_F(RoomJson, ARoomWithoutUnitKeepsThatAndItsMatrix) {
  MeasuredRoom room = rescaled(sample_room::make(), 0.25);
  room.metric = false;
  room.scale_source = ScaleSource::kUnknown;
  write_room(file_, room);
  const MeasuredRoom read = read_room(file_);
  EXPECT_FALSE(read.metric);
  EXPECT_NEAR(read.to_room.scale, 0.25, 1e-12);
  const Vec3d p{3, -1, 2};
  EXPECT_NEAR(norm(read.to_room * p - room.to_room * p), 0, 1e-12);
}

TEST_F(RoomJson, ARoomFoundWithoutLabelsSaysSo) {
  MeasuredRoom room = sample_room::make();
  room.found_by = RoomEvidence::kGeometry;
  write_room(file_, room);
  EXPECT_EQ(read_room(file_).found_by, RoomEvidence::kGeometry);
  EXPECT_EQ(parse_json(read_file(file_))["found_by"], "geometry");
}

TEST_F(RoomJson, AFileOfAnEarlierVersionWasFoundByLabels) {
  EXPECT_EQ(error_after([](auto& d) { d.erase("found_by"); }), "no error");
  EXPECT_EQ(read_room(file_).found_by, RoomEvidence::kLabels);
}

TEST_F(RoomJson, HolesAreDoorsAndWindowsAlone) {
  const nlohmann::json document = parse_json(room_json(sample_room::make()));
  EXPECT_EQ(document["walls"][0]["holes"].size(), 1u);
  EXPECT_EQ(document["walls"][1]["holes"].size(), 1u);
  EXPECT_EQ(document["walls"][2]["holes"].size(), 0u) << "a picture is no hole";
}

TEST_F(RoomJson, ErrorsNameTheField) {
  EXPECT_EQ(error_after([](auto& d) { d.erase("schema"); }), "schema");
  EXPECT_EQ(error_after([](auto& d) { d["schema"] = kRoomSchema + 1; }), "schema");
  EXPECT_EQ(error_after([](auto& d) { d["walls"][0]["to"][0] = nullptr; }), "to");
  EXPECT_EQ(error_after([](auto& d) { d["walls"][0]["to"] = {9, 9}; }), "walls");
  EXPECT_EQ(error_after([](auto& d) {
              d["walls"].erase(1);
              d["walls"].erase(1);
            }),
            "walls");
  EXPECT_EQ(error_after([](auto& d) { d["openings"][0]["wall"] = "wall.9"; }), "wall");
  EXPECT_EQ(error_after([](auto& d) { d["objects"][0]["size"] = "large"; }), "size");
  EXPECT_EQ(error_after([](auto& d) { d["objects"][0]["instance"] = 1e308; }), "instance");
  EXPECT_EQ(error_after([](auto& d) { d["objects"][0]["instance"] = 1.5; }), "instance");
  EXPECT_EQ(error_after([](auto& d) { d["scale"]["source"] = "guess"; }), "source");
  EXPECT_EQ(error_after([](auto& d) { d["found_by"] = "guess"; }), "found_by");
  EXPECT_EQ(error_after([](auto& d) { d["frame"]["world_to_room"][0] = {0, 0, 0, 0}; }), "world_to_room");
}

TEST_F(RoomJson, AFileThatIsNoJsonIsAnError) {
  write_file_atomically(file_, "walls");
  EXPECT_THROW(read_room(file_), Error);
  std::filesystem::remove(file_);
  EXPECT_THROW(read_room(file_), Error);
}

}  // namespace
}  // namespace aligngs
