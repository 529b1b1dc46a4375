#include "serve/room_scale_service.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "io/json_text.h"
#include "room/room_json.h"
#include "room/testing/sample_room.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

class RoomScaleService : public testing::Test {
 protected:
  void SetUp() override {
    run_ = fs::path(testing::TempDir()) / "aligngs_room_scale_service";
    fs::remove_all(run_);
    fs::create_directories(run_);
    write_room(run_ / "room.json", sample_room::make());
    serve_scale(
        run_, [](const MeasuredRoom&) { return sample_room::make(); }, options_);
  }

  std::string ask(const std::string& body) { return options_.post.at("/api/scale")(body); }

  /// The field that a refusal names.
  std::string refused(const std::string& body) {
    try {
      ask(body);
    } catch (const Error& error) {
      return error.details().field;
    }
    return "taken";
  }

  fs::path run_;
  ViewServerOptions options_;
};

TEST_F(RoomScaleService, AKnownLengthScalesTheRoom) {
  const auto answer = parse_json(ask(R"({"from": [0, 0, 0], "to": [0, 0.8, 0], "metres": 1.2})"));
  EXPECT_NEAR(answer["factor"].get<double>(), 1.5, 1e-9);
  const MeasuredRoom room = read_room(run_ / "room.json");
  EXPECT_NEAR(room.height, 1.5 * 2.5, 1e-6);
  EXPECT_EQ(room.scale_source, ScaleSource::kGiven);
}

TEST_F(RoomScaleService, AGivenScaleIsTakenBack) {
  ask(R"({"from": [0, 0, 0], "to": [0, 0.8, 0], "metres": 1.2})");
  EXPECT_NEAR(parse_json(ask(R"({"reset": true})"))["factor"].get<double>(), 1 / 1.5, 1e-9);
  EXPECT_NEAR(read_room(run_ / "room.json").height, 2.5, 1e-6);
}

TEST_F(RoomScaleService, RefusalsNameTheFieldAndChangeNothing) {
  EXPECT_EQ(refused("[]"), "");
  EXPECT_EQ(refused("{}"), "from");
  EXPECT_EQ(refused(R"({"from": [0, 0, 0], "to": [0, 1], "metres": 1})"), "to");
  EXPECT_EQ(refused(R"({"from": [0, 0, "0"], "to": [0, 1, 0], "metres": 1})"), "from");
  EXPECT_EQ(refused(R"({"from": [0, 0, 0], "to": [0, 1, 0]})"), "metres");
  EXPECT_NE(refused(R"({"from": [0, 0, 0], "to": [0, 1, 0], "metres": 0})"), "taken");
  EXPECT_NE(refused(R"({"from": [0, 0, 0], "to": [0, 0, 0], "metres": 1})"), "taken");
  EXPECT_NEAR(read_room(run_ / "room.json").height, 2.5, 1e-6);
}

TEST_F(RoomScaleService, ARunWithoutARoomIsToldWhatToDo) {
  fs::remove(run_ / "room.json");
  try {
    ask(R"({"from": [0, 0, 0], "to": [0, 1, 0], "metres": 1})");
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("aligngs room"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace aligngs
