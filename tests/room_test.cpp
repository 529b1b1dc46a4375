// `aligngs room`, `aligngs scale` and plans as a user meets them, on a run trained for a moment.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include "gaussians/gaussian_ply.h"
#include "io/atomic_file.h"
#include "io/json_text.h"
#include "room/room_json.h"
#include "support/process.h"
#include "support/small_scene.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::ProcessResult;
using testing_support::run_aligngs;

class RoomCommand : public testing::Test {
 protected:
  static fs::path root() { return fs::path(testing::TempDir()) / "room_command"; }
  static ProcessResult aligngs(const std::string& arguments) { return run_aligngs(arguments, root() / "scratch"); }
  static std::string quoted(const fs::path& path) { return "'" + path.string() + "'"; }

  static void SetUpTestSuite() {
    fs::remove_all(root());
    testing_support::write_small_scene(root() / "scene");
    const ProcessResult trained =
        aligngs("train " + quoted(root() / "scene") + " -o " + quoted(root() / "trained") + " -n 40 -q");
    ASSERT_EQ(trained.status, 0) << trained.err;
    const ProcessResult room = aligngs("room " + quoted(root() / "trained") + " -q");
    ASSERT_EQ(room.status, 0) << room.err;
  }
  /// Every test has a copy of the run.
  void SetUp() override {
    run_ = root() / testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(run_);
    fs::copy(root() / "trained", run_, fs::copy_options::recursive);
  }
  ProcessResult on_run(const std::string& command, const std::string& arguments = {}) const {
    return aligngs(command + " " + quoted(run_) + " -q " + arguments);
  }
  fs::path run_;
};

TEST_F(RoomCommand, TheFileIsWhatJsonPrints) {
  const ProcessResult result = on_run("room", "--json");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out, read_file(run_ / "room.json"));
  EXPECT_GE(read_room(run_ / "room.json").walls.size(), 3u);
}

TEST_F(RoomCommand, AGivenLengthSetsTheScaleAndStays) {
  const double before = read_room(run_ / "room.json").height;
  ASSERT_EQ(on_run("scale", "--object ceiling --height " + std::to_string(2 * before)).status, 0);
  EXPECT_NEAR(read_room(run_ / "room.json").to_room.scale, 2, 1e-3);
  ASSERT_EQ(on_run("room").status, 0);
  const MeasuredRoom again = read_room(run_ / "room.json");
  EXPECT_EQ(again.scale_source, ScaleSource::kGiven);
  EXPECT_NEAR(again.height, 2 * before, 1e-2 * before);
  ASSERT_EQ(on_run("scale", "--reset").status, 0);
  EXPECT_NEAR(read_room(run_ / "room.json").height, before, 1e-2 * before);
}

TEST_F(RoomCommand, TheScaleFromTwoPoints) {
  ASSERT_EQ(on_run("scale", "--between 0,1,2 1,1,2 3").status, 0);
  EXPECT_NEAR(read_room(run_ / "room.json").to_room.scale, 3, 1e-9);
  // The second call finds its work done, and the file stays to the last digit.
  for (const double metres : {3.0, 0.9 / 0.7}) {
    const std::string command = fmt::format("--between 0,1,2 1,1,2 {:.17g}", metres);
    ASSERT_EQ(on_run("scale", command).status, 0);
    const std::string once = read_file(run_ / "room.json");
    ASSERT_EQ(on_run("scale", command).status, 0);
    EXPECT_EQ(read_file(run_ / "room.json"), once) << metres;
  }
}

TEST_F(RoomCommand, WrongScalesAreErrorsAndChangeNothing) {
  const std::string before = read_file(run_ / "room.json");
  for (const char* wrong : {"", "--object ceiling", "--object piano --height 1", "--object ceiling --height -1",
                            "--height 2", "--between 0,0,0 0,0,0 1", "--between 0,0 1,1,1 1", "--between 0,0,0 1,1,1 x",
                            "--reset", "--object ceiling --height nan"}) {
    EXPECT_EQ(on_run("scale", wrong).status, 2) << wrong;
  }
  EXPECT_EQ(read_file(run_ / "room.json"), before);
}

TEST_F(RoomCommand, PlansAreWrittenBesideTheRun) {
  for (const char* format : {"plan.svg", "plan.dxf", "plan.pdf"}) {
    ASSERT_EQ(on_run("export", std::string("-f ") + format).status, 0) << format;
    EXPECT_GT(fs::file_size(run_ / format), 1000u) << format;
  }
  EXPECT_EQ(on_run("export", "-f plan.svg -o '" + (root() / "plan.dxf").string() + "'").status, 2)
      << "the name says another format";
}

TEST_F(RoomCommand, PlansFollowTheEdits) {
  const auto objects_of_plan = [&](const std::string& options) -> size_t {
    const ProcessResult made = on_run("export", "--json -f plan.svg " + options);
    EXPECT_EQ(made.status, 0) << made.err;
    return parse_json(made.out)["objects"].get<size_t>();
  };
  const std::vector<MeasuredBox> boxes = read_room(run_ / "room.json").boxes;
  ASSERT_FALSE(boxes.empty());
  EXPECT_EQ(objects_of_plan(""), boxes.size());
  ASSERT_EQ(on_run("edit", "--select " + boxes[0].class_name + " --delete").status, 0);
  EXPECT_LT(objects_of_plan(""), boxes.size());
  EXPECT_EQ(objects_of_plan("--original"), boxes.size());
  EXPECT_EQ(read_room(run_ / "room.json").boxes.size(), boxes.size()) << "the file is as it was measured";
}

TEST_F(RoomCommand, AnOlderRoomJsonIsNoPlanOfTheEdits) {
  MeasuredRoom room = read_room(run_ / "room.json");
  ASSERT_FALSE(room.boxes.empty());
  for (MeasuredBox& box : room.boxes) box.shown.reset();
  write_room(run_ / "room.json", room);
  ASSERT_EQ(on_run("edit", "--select bed --recolor red").status, 0);
  const ProcessResult made = on_run("export", "--json -f plan.svg");
  EXPECT_EQ(parse_json(made.out)["edits"], 0);
  EXPECT_THAT(made.err, HasSubstr("aligngs room"));
}

TEST_F(RoomCommand, WithoutRoomJsonThereIsNoPlanAndNoScale) {
  fs::remove(run_ / "room.json");
  const ProcessResult plan = on_run("export", "-f plan.svg");
  EXPECT_EQ(plan.status, 3);
  EXPECT_THAT(plan.err, HasSubstr("aligngs room"));
  EXPECT_FALSE(fs::exists(run_ / "plan.svg"));
  EXPECT_EQ(on_run("scale", "--object ceiling --height 2").status, 3);
}

TEST_F(RoomCommand, ADamagedRoomJsonIsBadInput) {
  write_file_atomically(run_ / "room.json", "{\"schema\": 1}");
  EXPECT_EQ(on_run("export", "-f plan.svg").status, 3);
  EXPECT_EQ(on_run("export", "-f ply").status, 3);
  EXPECT_EQ(on_run("export", "-f ply --keep-frame").status, 0);
  EXPECT_EQ(on_run("scale", "--between 0,0,0 1,1,1 1").status, 3);
}

TEST_F(RoomCommand, ExportsAreInTheFrameOfTheRoomUnlessToldOtherwise) {
  ASSERT_EQ(on_run("export", "-f ply --keep-frame -o '" + (root() / "kept.ply").string() + "'").status, 0);
  ASSERT_EQ(on_run("export", "-f ply -o '" + (root() / "moved.ply").string() + "'").status, 0);
  const GaussianModel own = read_gaussian_ply(run_ / "scene.ply"), kept = read_gaussian_ply(root() / "kept.ply"),
                      moved = read_gaussian_ply(root() / "moved.ply");
  ASSERT_EQ(own.size(), moved.size());
  EXPECT_EQ(own.positions, kept.positions);
  const Vec3d p = read_room(run_ / "room.json").to_room * Vec3d{own.positions[0], own.positions[1], own.positions[2]};
  EXPECT_NEAR(moved.positions[0], p.x, 1e-3);
  EXPECT_NEAR(moved.positions[1], -p.z, 1e-3) << "y is down";
  EXPECT_NEAR(moved.positions[2], p.y, 1e-3);
}

}  // namespace
}  // namespace aligngs
