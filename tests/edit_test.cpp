// `aligngs edit` and `aligngs export` as a user meets them, on a run trained for a moment.
#include <gmock/gmock.h>

#include <algorithm>
#include <csignal>
#include <nlohmann/json.hpp>
#include <thread>

#include "edit/edit_lock.h"
#include "edit/edit_operation.h"
#include "gaussians/gaussian_ply.h"
#include "io/atomic_file.h"
#include "io/json_text.h"
#include "support/process.h"
#include "support/small_scene.h"
#include "support/started_process.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::ProcessResult;
using testing_support::run_aligngs;

class EditCommand : public testing::Test {
 protected:
  static fs::path root() { return fs::path(testing::TempDir()) / "edit_command"; }
  static ProcessResult aligngs(const std::string& arguments) { return run_aligngs(arguments, root() / "scratch"); }
  static std::string quoted(const fs::path& path) { return "'" + path.string() + "'"; }

  static void SetUpTestSuite() {
    fs::remove_all(root());
    testing_support::write_small_scene(root() / "scene");
    const ProcessResult trained =
        aligngs("train " + quoted(root() / "scene") + " -o " + quoted(root() / "trained") + " -n 40 -q");
    ASSERT_EQ(trained.status, 0) << trained.err;
    ASSERT_EQ(aligngs("mesh " + quoted(root() / "trained") + " --set mesh.voxel=0.05 -q").status, 0);
  }
  /// Every test has a copy of the run.
  void SetUp() override {
    run_ = root() / testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(run_);
    fs::copy(root() / "trained", run_, fs::copy_options::recursive);
    fs::remove_all(root() / "out");
  }
  ProcessResult edit(const std::string& arguments) const {
    return aligngs("edit " + quoted(run_) + " -q " + arguments);
  }
  nlohmann::json edit_json(const std::string& arguments) const {
    const ProcessResult result = edit("--json " + arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    return parse_json(result.out);
  }
  /// The edited room as it leaves the program.
  GaussianModel exported(const std::string& format) const {
    const fs::path file = root() / ("exported." + format);
    const ProcessResult result = aligngs("export " + quoted(run_) + " -q -f " + format + " -o " + quoted(file));
    EXPECT_EQ(result.status, 0) << result.err;
    return read_gaussian_ply(file);
  }
  fs::path run_;
};

TEST_F(EditCommand, ListsTheObjectsOfTheRoom) {
  const nlohmann::json list = edit_json("--list");
  EXPECT_TRUE(list["edits"].empty());
  std::vector<std::string> names;
  for (const auto& object : list["objects"]) names.push_back(object["object"]);
  EXPECT_THAT(names, testing::IsSupersetOf({"wall#1", "floor#1", "bed#1"}));
}

TEST_F(EditCommand, ListsTheSizesOfTheObjects) {
  for (const auto& object : edit_json("--list")["objects"]) {
    ASSERT_EQ(object["size_m"].size(), 3u) << object["object"];
    EXPECT_GE(object["size_m"][0].get<double>(), object["size_m"][1].get<double>()) << object["object"];
  }
  EXPECT_THAT(edit("--list").out, testing::ContainsRegex("bed#1 +[0-9]+ x [0-9]+ x [0-9]+ cm +[0-9]+ Gaussians"));
}

TEST_F(EditCommand, NamesWhatTheRoomLacks) {
  EXPECT_EQ(edit_json("--select 'bed, streetlight' --highlight red")["absent"], nlohmann::json{"streetlight"});
}

TEST_F(EditCommand, ACopyAddsOneObject) {
  const auto count = [&] { return edit_json("--list")["objects"].size(); };
  const size_t before = count();
  edit_json("--select 'the largest bed' --duplicate");
  EXPECT_EQ(count(), before + 1) << "no crumbs of what was beside it";
}

TEST_F(EditCommand, AnEditGoesOnTheStackAndUndoTakesItBack) {
  const std::string before = read_file(run_ / "scene.ply");
  const nlohmann::json report = edit_json("--select bed --delete");
  EXPECT_EQ(report["gaussians_after"].get<int>(),
            report["gaussians_before"].get<int>() - report["selected_gaussians"].get<int>());
  EXPECT_EQ(exported("ply").size(), report["gaussians_after"].get<size_t>());
  ASSERT_EQ(read_edits(run_ / "edits.json").size(), 1u);
  EXPECT_LT(fs::file_size(run_ / "edits" / read_edits(run_ / "edits.json")[0].change),
            fs::file_size(run_ / "scene.ply") / 10);
  edit_json("--select wall --recolor '#add8e6'");
  EXPECT_EQ(edit_json("--list")["edits"], (nlohmann::json{"delete bed, hole left open", "recolor wall to #add8e6"}));
  EXPECT_EQ(read_file(run_ / "scene.ply"), before) << "what was trained is never touched";
  edit_json("--undo");
  edit_json("--undo");
  EXPECT_TRUE(edit_json("--list")["edits"].empty());
  EXPECT_FALSE(fs::exists(run_ / "edits"));
  EXPECT_EQ(edit("--undo").status, 2);
}

TEST_F(EditCommand, AnEditInWordsIsTheSameEdit) {
  edit_json("--say 'paint all the walls light blue'");
  edit_json("--say 'get rid of the first bed, please'");
  EXPECT_EQ(edit_json("--list")["edits"], (nlohmann::json{"recolor wall to #add8e6", "delete bed#1, hole filled"}));
  EXPECT_EQ(edit_json("--say 'undo the first edit'")["undone"], "recolor wall to #add8e6");
  EXPECT_EQ(edit_json("--list")["edits"], (nlohmann::json{"delete bed#1, hole filled"})) << "the later edit stays";
}

TEST_F(EditCommand, AnObjectMovesAndComesBack) {
  const std::string before = read_file(run_ / "scene.ply");
  const nlohmann::json moved = edit_json("--select bed --move -0.3,0,0.1 --turn 20");
  EXPECT_EQ(moved["gaussians_after"].get<int>(), moved["gaussians_before"].get<int>() +
                                                     moved["filled_gaussians"].get<int>() -
                                                     moved["cleared_gaussians"].get<int>());
  EXPECT_EQ(edit_json("--list")["edits"], (nlohmann::json{"move bed by -0.3,0,0.1 and turn by 20"}));
  edit_json("--say 'duplicate the largest bed'");
  edit_json("--undo");
  edit_json("--undo");
  EXPECT_FALSE(fs::exists(run_ / "edits"));
  EXPECT_EQ(read_file(run_ / "scene.ply"), before);
  EXPECT_EQ(edit("--select bed --move 1,2").status, 2);
  EXPECT_EQ(edit("--select bed --turn 999").status, 2);
  EXPECT_EQ(edit("--select bed --recolor red --with-contents").status, 2);
}

TEST_F(EditCommand, TwoEditsAtOnceAreBothKept) {
  const auto start = [&](const char* select, const char* color, const char* scratch) {
    return std::make_unique<testing_support::StartedProcess>(
        std::vector<std::string>{"edit", run_.string(), "-q", "--select", select, "--highlight", color},
        root() / scratch);
  };
  const auto first = start("wall", "#ff0000", "first"), second = start("bed", "#00ff00", "second");
  EXPECT_EQ(first->wait(60), 0) << first->err();
  EXPECT_EQ(second->wait(60), 0) << second->err();
  const nlohmann::json list = edit_json("--list")["edits"];
  EXPECT_THAT(list, testing::UnorderedElementsAre("highlight wall in #ff0000", "highlight bed in #00ff00"));
}

TEST_F(EditCommand, AnEditThatCannotWaitNamesTheHolder) {
  const EditLock lock(run_, "delete sofa", 1);
  const ProcessResult result = edit("--wait 0.2 --select wall --highlight '#ff0000'");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("process " + std::to_string(getpid())));
  EXPECT_THAT(result.err, HasSubstr("delete sofa"));
  EXPECT_FALSE(fs::exists(run_ / "edits.json"));
}

TEST_F(EditCommand, DryRunOnlyDraws) {
  const fs::path picture = run_.parent_path() / "preview.png";
  const nlohmann::json report = edit_json("--select bed --delete --fill --dry-run --picture " + quoted(picture));
  EXPECT_GT(report["selected_gaussians"], 0);
  EXPECT_TRUE(fs::exists(picture));
  EXPECT_FALSE(fs::exists(run_ / "edits.json"));
  EXPECT_FALSE(fs::exists(run_ / "edits"));
}

TEST_F(EditCommand, WithOutputTheResultIsARunAgain) {
  const fs::path out = root() / "out";
  const nlohmann::json report = edit_json("--select bed --extract -o " + quoted(out));
  EXPECT_FALSE(fs::exists(run_ / "edits.json")) << "the run is untouched";
  for (const char* file :
       {"run.json", "config.toml", "scene.ply", "scene.labels.ply", "classes.json", "cameras.json", "mesh/mesh.ply",
        "before_after.png", "object/scene.ply", "object/object.glb", "renders/test/rgb"}) {
    EXPECT_TRUE(fs::exists(out / file)) << file;
  }
  EXPECT_EQ(read_gaussian_ply(out / "scene.ply").size(), report["selected_gaussians"].get<size_t>());
  EXPECT_EQ(aligngs("render " + quoted(out) + " -q").status, 0);
  EXPECT_EQ(aligngs("edit " + quoted(out) + " --list -q").status, 0);
  EXPECT_EQ(aligngs("info " + quoted(out)).status, 0);
  const ProcessResult taken = edit("--select bed --delete -o " + quoted(out));
  EXPECT_EQ(taken.status, 2) << "the place is taken";
}

TEST_F(EditCommand, AnEditTwiceIsTheSameBytes) {
  edit_json("--select bed --delete --fill");
  const std::string first = read_file(run_ / "edits.json"), name = read_edits(run_ / "edits.json")[0].change;
  const std::string change = read_file(run_ / "edits" / name);
  edit_json("--undo");
  edit_json("--threads 1 --select bed --delete --fill");
  EXPECT_EQ(read_file(run_ / "edits.json"), first);
  EXPECT_TRUE(read_file(run_ / "edits" / name) == change);
}

TEST_F(EditCommand, UndoNeedsNeitherCheckpointsNorScene) {
  edit_json("--select bed --recolor red");
  fs::remove_all(run_ / "checkpoints");
  fs::remove(run_ / "scene.labels.ply");
  EXPECT_EQ(edit_json("--undo")["undone"], "recolor bed to #ff0000");
  EXPECT_FALSE(fs::exists(run_ / "edits"));
}

TEST_F(EditCommand, TheLabelledSceneIsEnough) {
  const size_t before = exported("ply").size();
  fs::remove_all(run_ / "checkpoints");
  fs::remove(run_ / "scene.ply");
  EXPECT_EQ(exported("ply").size(), before);
  const nlohmann::json report = edit_json("--select bed --delete");
  EXPECT_EQ(exported("ply").size(), report["gaussians_after"].get<size_t>());
  EXPECT_EQ(edit_json("--undo")["undone"], "delete bed, hole left open");
}

TEST_F(EditCommand, AnEarlierEditIsTakenBackWithWhatFollowsFromIt) {
  edit_json("--select wall --recolor '#add8e6'");
  edit_json("--select wall --recolor '#ff0000'");
  edit_json("--say 'undo the first edit'");
  const GaussianModel red = exported("ply");
  edit_json("--undo");
  edit_json("--select wall --recolor '#ff0000'");
  EXPECT_EQ(exported("ply").sh, red.sh) << "as if the first had never been";
}

TEST_F(EditCommand, ARefusedUndoNamesTheEditThatNeedsIt) {
  const auto names = [&] {
    std::vector<std::string> found;
    const nlohmann::json listed = edit_json("--list");
    for (const auto& object : listed["objects"]) found.push_back(object["object"]);
    return found;
  };
  const std::vector<std::string> before = names();
  edit_json("--select 'the largest bed' --duplicate");
  std::string copy;
  for (const std::string& name : names()) {
    if (std::find(before.begin(), before.end(), name) == before.end()) copy = name;
  }
  edit_json("--select '" + copy + "' --recolor '#0000ff'");
  const ProcessResult refused = edit("--say 'undo the first edit'");
  EXPECT_NE(refused.status, 0);
  EXPECT_THAT(refused.err, testing::AllOf(HasSubstr("edit 2"), HasSubstr("needs edit 1"), HasSubstr("undo #2")));
}

TEST_F(EditCommand, ARunWithoutCheckpointsIsEditedAndExported) {
  const nlohmann::json with = edit_json("--select bed --delete --fill --dry-run --picture " + quoted(root() / "a.png"));
  fs::remove_all(run_ / "checkpoints");
  const nlohmann::json without = edit_json("--select bed --delete --fill");
  EXPECT_EQ(without["gaussians_after"], with["gaussians_after"]);
  EXPECT_EQ(exported("labels.ply").size(), without["gaussians_after"].get<size_t>());
  for (const char* needs : {"--select bed --recolor red --threshold 0.3", "--select bed --extract -o OUT"}) {
    std::string command = needs;
    if (const size_t at = command.find("OUT"); at != std::string::npos) command.replace(at, 3, quoted(root() / "out"));
    const ProcessResult refused = edit(command);
    EXPECT_EQ(refused.status, 3) << command;
    EXPECT_THAT(refused.err, HasSubstr("no checkpoints"));
  }
  EXPECT_FALSE(fs::exists(root() / "out"));
}

TEST_F(EditCommand, ARunThatAnEarlierProgramEditedKeepsItsEdits) {
  fs::create_directories(run_ / "edits");
  write_file_atomically(run_ / "edits" / "scene.ply", "a copy of the room");
  write_file_atomically(
      run_ / "edits.json",
      R"({"schema": 1, "edits": [{"operation": "delete", "select": "bed", "threshold": "argmax", "fill": false}]})");
  EXPECT_EQ(edit_json("--list")["edits"], nlohmann::json{"delete bed, hole left open"});
  const size_t rest = exported("ply").size();
  EXPECT_LT(rest, read_gaussian_ply(run_ / "scene.ply").size());
  edit_json("--select wall --recolor red");
  EXPECT_EQ(exported("ply").size(), rest);
  EXPECT_FALSE(fs::exists(run_ / "edits" / "scene.ply")) << "the copy would be of another room now";
  for (const EditOperation& e : read_edits(run_ / "edits.json"))
    EXPECT_TRUE(fs::exists(run_ / "edits" / e.change)) << describe(e);
}

TEST_F(EditCommand, ADamagedChangeIsMadeAgainFromItsWords) {
  edit_json("--select bed --delete");
  const size_t rest = exported("ply").size();
  write_file_atomically(run_ / "edits" / read_edits(run_ / "edits.json")[0].change, "damaged");
  const ProcessResult list = aligngs("edit " + quoted(run_) + " --list");
  EXPECT_EQ(list.status, 0);
  EXPECT_THAT(list.err, HasSubstr("is carried out again"));
  EXPECT_EQ(exported("ply").size(), rest);
}

TEST_F(EditCommand, AKilledEditLeavesTheOldStateOrTheNewOne) {
  edit_json("--select wall --recolor red");
  const std::string before = read_file(run_ / "edits.json");
  for (const int milliseconds : {5, 40, 80, 120, 160, 240}) {
    testing_support::StartedProcess process({"edit", run_.string(), "-q", "--select", "bed", "--delete"},
                                            root() / "killed");
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    process.send(SIGKILL);
    process.wait(60);
    const size_t edits = edit_json("--list")["edits"].size();
    ASSERT_TRUE(edits == 1 || edits == 2);
    if (edits == 2) edit_json("--undo");
    EXPECT_EQ(read_file(run_ / "edits.json"), before);
  }
}

TEST_F(EditCommand, MistakesAreClearAndChangeNothing) {
  const auto expect = [&](const std::string& arguments, int status, const char* words) {
    const ProcessResult result = edit(arguments);
    EXPECT_EQ(result.status, status) << arguments << "\n" << result.err;
    EXPECT_THAT(result.err, HasSubstr(words)) << arguments;
    EXPECT_THAT(result.err, HasSubstr("remedy")) << arguments;
  };
  expect("--select bedd --delete", 2, "did you mean \"bed\"");
  expect("--select car --delete", 3, "no object that is");
  expect("--select bed", 2, "exactly one of");
  expect("--select bed --delete --extract", 2, "exactly one of");
  expect("--delete", 2, "nothing is selected");
  expect("--select bed --recolor bleu", 2, "no colour");
  expect("--say 'delte bed'", 2, "did you mean \"delete bed\"");
  expect("--say 'undo the second edit'", 2, "no edit to undo");
  expect("--say 'delete bed' --select bed", 2, "--say");
  expect("--undo --select bed --recolor blue", 2, "--undo is a command of its own");
  expect("--list --select bed", 2, "--list is a command of its own");
  expect("--select bed --delete --threshold 7", 2, "no threshold");
  expect("--select everything --delete", 3, "nothing would be left");
  expect("--select everything --move=1,0,0", 3, "nothing else remains that could hold");
  expect("--select bed --move=0,0,0", 2, "nothing would move");
  expect("--select bed --turn 360", 2, "nothing would move");
  expect("--say 'move bed 0 cm left'", 2, "nothing would move");
  expect("--dele --select bed", 2, "did you mean: --delete");
  expect("--select bed --replace " + quoted(run_) + "#spoonbill", 2, "--replace");
  expect("--select bed --replace " + quoted(run_) + "#streetlight", 3, "name one of its objects");
  expect("--select bed --up y --replace " + quoted(run_) + "#bed#1", 2, "--up is for a file of splats");
  expect("--select wall --extract --fill", 2, "--delete");
  EXPECT_FALSE(fs::exists(run_ / "edits.json"));
  write_file_atomically(run_ / "edits.json", "{\"schema\": 1, \"edits\": [{\"operation\": \"explode\"}]}");
  expect("--list", 3, "edits[0].operation");
  EXPECT_EQ(aligngs("edit " + quoted(root() / "scene") + " --list").status, 3) << "a scene is no run";
}

TEST_F(EditCommand, MeasureComparesWithTheTruth) {
  const nlohmann::json score = edit_json("--select floor --measure");
  EXPECT_GT(score["label_iou"], 0.4);
  EXPECT_GT(score["precision"], 0.2);
}

TEST_F(EditCommand, ExportWritesEveryFormatWithTheEdits) {
  edit_json("--select bed --delete");
  for (const char* format : {"ply", "labels.ply", "glb", "collision.glb", "obj", "sog", "spz", "splat", "usdz"}) {
    const fs::path file = root() / (std::string("export.") + format);
    const ProcessResult result = aligngs("export " + quoted(run_) + " -q --json -f " + format + " -o " + quoted(file));
    ASSERT_EQ(result.status, 0) << format << result.err;
    EXPECT_EQ(parse_json(result.out)["edits"], 1);
    EXPECT_GT(fs::file_size(file), 100u) << format;
  }
  EXPECT_LT(read_gaussian_ply(root() / "export.ply").size(), read_gaussian_ply(run_ / "scene.ply").size());
  for (const char* wrong :
       {" -f gbl", " -f glb -o '/tmp/room.spz'", " -f spz --only mesh", " -f glb --only doors",
        " -f glb --mesh-only --splats-only", " -f ply --triangles 100", " -f glb --splats-only --textured",
        " -f collision.glb --textured", " -f glb --triangles 0", " -f glb --object spoonbill"}) {
    EXPECT_EQ(aligngs("export " + quoted(run_) + wrong).status, 2) << wrong;
  }
}

TEST_F(EditCommand, ExportShapesTheMesh) {
  const auto exported = [&](const std::string& options, const std::string& name) {
    const ProcessResult result =
        aligngs("export " + quoted(run_) + " -q --json " + options + " -o " + quoted(root() / name));
    EXPECT_EQ(result.status, 0) << options << result.err;
    return parse_json(result.out);
  };
  const nlohmann::json few = exported("-f glb --mesh-only --triangles 2000 --closed", "few.glb");
  // Borders of this room's many small objects keep more than 2000.
  EXPECT_LT(2 * few["triangles"].get<size_t>(), few["triangles_before"].get<size_t>());
  EXPECT_EQ(few["open_edges"], 0);
  EXPECT_EQ(few["gaussians"], 0);
  const nlohmann::json textured = exported("-f obj --textured --error 20", "textured.obj");
  EXPECT_EQ(textured["files"].size(), 3u);
  EXPECT_TRUE(fs::exists(root() / "textured.jpg"));
  EXPECT_EQ(exported("-f glb --object bed", "bed.glb")["objects"],
            exported("-f glb --object bed --mesh-only", "bed_mesh.glb")["objects"]);
}

}  // namespace
}  // namespace aligngs
