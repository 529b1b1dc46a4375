// A user's files are never lost: no command writes into its source or over a folder that aligngs did not write.
#include <gmock/gmock.h>

#include <algorithm>
#include <map>

#include "io/atomic_file.h"
#include "support/process.h"
#include "support/small_scene.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::ProcessResult;
using testing_support::run_aligngs;

std::string quoted(const fs::path& path) { return "'" + path.string() + "'"; }

/// Every file below a folder with its content.
std::map<std::string, std::string> contents(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files[entry.path().lexically_relative(folder).string()] = read_file(entry.path());
  }
  return files;
}

class DataLoss : public testing::Test {
 protected:
  static fs::path original() { return fs::path(testing::TempDir()) / "data_loss_original"; }
  static void SetUpTestSuite() { testing_support::write_small_scene(original()); }
  static void TearDownTestSuite() { fs::remove_all(original()); }
  /// A data set as other programs leave it: photos, a COLMAP model, a database, notes, and a run of somebody else.
  void SetUp() override {
    root_ = fs::path(testing::TempDir()) / "data_loss" / testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(root_);
    fs::create_directories(root_);
    fs::copy(original(), root_ / "made", fs::copy_options::recursive);
    fs::create_directories(data());
    for (const char* part : {"images", "sparse"})
      fs::copy(root_ / "made" / part, data() / part, fs::copy_options::recursive);
    for (const char* file : {"database.db", "notes.txt", "config.toml", "run.json"})
      write_file_atomically(data() / file, "{}");
    fs::create_directory_symlink(data(), root_ / "link");
    before_ = contents(data());
  }
  fs::path data() const { return root_ / "data"; }
  ProcessResult aligngs(const std::string& arguments) const {
    return run_aligngs(arguments + " -q", root_ / "scratch");
  }
  /// The command ends with a usage error, and the data set is what it was.
  void expect_refused(const std::string& arguments, const char* words = "source") const {
    const ProcessResult result = aligngs(arguments);
    EXPECT_EQ(result.status, 2) << arguments << "\n" << result.err;
    EXPECT_THAT(result.err, HasSubstr(words)) << arguments;
    EXPECT_THAT(result.err, HasSubstr("remedy")) << arguments;
    EXPECT_TRUE(contents(data()) == before_) << arguments;
  }
  fs::path root_;
  std::map<std::string, std::string> before_;
};

TEST_F(DataLoss, NoCommandWritesOverItsSource) {
  for (const fs::path& output : {data(), root_ / "link", data() / "images" / "..", data() / ""}) {
    expect_refused("import " + quoted(data()) + " --overwrite -o " + quoted(output));
    expect_refused("poses " + quoted(data() / "images") + " --method given --overwrite -o " + quoted(output));
    expect_refused("refine " + quoted(data()) + " --overwrite -o " + quoted(output));
    expect_refused("data simulate " + quoted(data()) + " --overwrite -o " + quoted(output));
    expect_refused("train " + quoted(data()) + " -n 1 --overwrite -o " + quoted(output), "");
    expect_refused("run " + quoted(data()) + " -n 1 --overwrite -o " + quoted(output), "");
  }
}

TEST_F(DataLoss, NoCommandWritesIntoItsSource) {
  for (const fs::path& output : {data() / "new", root_ / "link" / "images" / "new"}) {
    expect_refused("import " + quoted(data()) + " -o " + quoted(output));
    expect_refused("refine " + quoted(data()) + " -o " + quoted(output));
    expect_refused("train " + quoted(data()) + " -n 1 -o " + quoted(output));
    expect_refused("run " + quoted(data()) + " -n 1 -o " + quoted(output));
  }
  expect_refused("poses " + quoted(data() / "images") + " --method given -o " + quoted(data() / "images" / "new"));
  expect_refused("poses " + quoted(data() / "images") + " --method given -o " + quoted(data() / "sparse" / "new"),
                 "data set");
  expect_refused("train " + quoted(root_ / "made") + " -n 1 -o " + quoted(data() / "images" / "new"), "data set");
  expect_refused("priors " + quoted(data()), "-o OUT");
}

TEST_F(DataLoss, NoCommandReplacesAFolderThatIsNotItsOwn) {
  for (const fs::path& output : {data(), root_ / "link"}) {
    expect_refused("import " + quoted(root_ / "made") + " --overwrite -o " + quoted(output), "never replaced");
    expect_refused("poses " + quoted(root_ / "made" / "images") + " --method given --overwrite -o " + quoted(output),
                   "never replaced");
    expect_refused("refine " + quoted(root_ / "made") + " --overwrite -o " + quoted(output), "never replaced");
    expect_refused("data simulate " + quoted(root_ / "made") + " --overwrite -o " + quoted(output), "never replaced");
    expect_refused("synth --size 32x24 --views 4 --test-views 1 --overwrite " + quoted(output), "never replaced");
    expect_refused("train " + quoted(root_ / "made") + " -n 1 --overwrite -o " + quoted(output), "holds no run");
    expect_refused("run " + quoted(root_ / "made") + " -n 1 --overwrite -o " + quoted(output), "holds no run");
    expect_refused("demo --overwrite -n 1 -o " + quoted(output), "holds no run");
  }
}

TEST_F(DataLoss, APhotoThatALinkBringsIsPartOfTheSource) {
  fs::create_directories(root_ / "linked");
  fs::copy(data() / "sparse", root_ / "linked" / "sparse", fs::copy_options::recursive);
  fs::create_directory_symlink(root_ / "made" / "images", root_ / "linked" / "images");
  const auto made = contents(root_ / "made");
  const ProcessResult result =
      aligngs("import " + quoted(root_ / "linked") + " --overwrite -o " + quoted(root_ / "made"));
  EXPECT_EQ(result.status, 2) << result.err;
  EXPECT_TRUE(contents(root_ / "made") == made);
}

TEST_F(DataLoss, AnOwnSceneIsReplacedWhenAsked) {
  const std::string command = "import " + quoted(data()) + " -o " + quoted(root_ / "made");
  EXPECT_EQ(aligngs(command).status, 2);
  const ProcessResult result = aligngs(command + " --overwrite");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_TRUE(contents(data()) == before_);
}

TEST_F(DataLoss, ExportsNeverReplaceAFileOfTheRunOrOfItsScene) {
  const fs::path run = root_ / "run";
  ASSERT_EQ(aligngs("train " + quoted(root_ / "made") + " -n 2 -o " + quoted(run)).status, 0);
  fs::create_directory_symlink(run, root_ / "run_link");
  const auto trained = contents(run), made = contents(root_ / "made");
  for (const fs::path& file :
       {run / "scene.ply", run / "run.json", run / "checkpoints" / "new.ply", root_ / "run_link" / "scene.ply",
        root_ / "data" / ".." / "run" / "scene.labels.ply", root_ / "made" / "sparse" / "points3D.ply"}) {
    for (const std::string& command : {"export " + quoted(run) + " -f ply -o ", "mesh " + quoted(run) + " -o "}) {
      const ProcessResult result = aligngs(command + quoted(file));
      EXPECT_EQ(result.status, 2) << command << file << result.err;
    }
  }
  EXPECT_EQ(aligngs("edit " + quoted(run) + " --select wall --delete -o " + quoted(run / "edited")).status, 2);
  const std::string photo = quoted(root_ / "made" / "images" / "view_000.png"), small = " --size 32x32";
  for (const std::string& options :
       {"render " + quoted(run) + " --view view_000 -o " + photo + small,
        "render " + quoted(run) + " --path orbit --seconds 0.1 -o " + photo + small,
        "mesh " + quoted(run) + " --pictures " + quoted(root_ / "made" / "images"),
        "mesh " + quoted(run) + " --pictures " + quoted(data() / "images"),
        "export " + quoted(run) + " -f ply -o " + quoted(run / "mesh" / "mesh.ply"),
        "compare " + quoted(run) + " " + quoted(run) + " --html " + quoted(root_ / "made" / "page.html")}) {
    const ProcessResult result = aligngs(options);
    EXPECT_EQ(result.status, 2) << options << result.err;
  }
  // Data of others: photos of a data set, its points, another run, a film.
  fs::copy(run, root_ / "other", fs::copy_options::recursive);
  write_file_atomically(root_ / "film.mp4", "of somebody");
  for (const std::string& options :
       {"render " + quoted(run) + " --view view_000 -o " + quoted(data() / "images" / "view_000.png") + small,
        "render " + quoted(run) + " --path orbit --seconds 0.1 -o " + quoted(root_ / "film.mp4") + small,
        "edit " + quoted(run) + " --select wall --delete --dry-run --picture " +
            quoted(data() / "images" / "view_000.png"),
        "export " + quoted(run) + " -f ply -o " + quoted(data() / "sparse" / "points3D.ply"),
        "export " + quoted(run) + " -f ply -o " + quoted(data() / "database.db"),
        "export " + quoted(run) + " -f ply -o " + quoted(root_ / "other" / "scene.ply"),
        "mesh " + quoted(run) + " -o " + quoted(root_ / "other" / "scene.ply"),
        "compare " + quoted(run) + " " + quoted(run) + " --csv " + quoted(root_ / "rooms.tsv")}) {
    write_file_atomically(data() / "sparse" / "points3D.ply", "points of somebody");
    const ProcessResult result = aligngs(options);
    EXPECT_EQ(result.status, 2) << options << result.err;
    EXPECT_EQ(read_file(data() / "sparse" / "points3D.ply"), "points of somebody");
  }
  fs::remove(data() / "sparse" / "points3D.ply");
  EXPECT_EQ(read_file(root_ / "film.mp4"), "of somebody");
  EXPECT_TRUE(contents(root_ / "other") == trained);
  const std::string view = "render " + quoted(run) + " --view view_000 -o " + quoted(root_ / "view.png") + small;
  for (int again = 0; again < 2; ++again) EXPECT_EQ(aligngs(view).status, 0) << "a drawn picture is replaced";

  EXPECT_TRUE(contents(data()) == before_);
  EXPECT_TRUE(contents(run) == trained);
  EXPECT_TRUE(contents(root_ / "made") == made);
  const ProcessResult result = aligngs("export " + quoted(run) + " -f ply");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_TRUE(read_file(run / "scene.ply") == trained.at("scene.ply"));
  EXPECT_TRUE(fs::exists(run / "scene.export.ply"));
}

TEST_F(DataLoss, ComparisonsReplaceTheirOwnFilesAlone) {
  const fs::path run = root_ / "run";
  ASSERT_EQ(aligngs("train " + quoted(root_ / "made") + " -n 2 -o " + quoted(run)).status, 0);
  ASSERT_EQ(aligngs("eval " + quoted(run)).status, 0);
  const std::string compare = "compare " + quoted(run) + " " + quoted(run);
  write_file_atomically(data() / "results.csv", "run,psnr\nmine,31\n");
  write_file_atomically(data() / "page.html", "<!doctype html><title>of somebody</title>");
  before_ = contents(data());
  expect_refused(compare + " --csv " + quoted(data() / "results.csv"), "never replaced");
  expect_refused(compare + " --csv " + quoted(data() / "sparse" / "results.csv"), "data set");
  expect_refused(compare + " --html " + quoted(data() / "page.html"), "never replaced");
  for (int again = 0; again < 2; ++again) {
    const ProcessResult result =
        aligngs(compare + " --csv " + quoted(data() / "own.csv") + " --html " + quoted(data() / "own.html"));
    EXPECT_EQ(result.status, 0) << result.err;
  }
}

/// The last page that would be written is the one of somebody else: no other page is there afterwards.
TEST_F(DataLoss, ManualPagesOfOthersAreNotReplacedAndOwnOnesAre) {
  const fs::path pages = data() / "pages";
  fs::create_directories(pages);
  write_file_atomically(pages / "aligngs-manual.1", ".TH ALIGNGS-MANUAL 1 \"May 2020\" \"of somebody\"\n");
  before_ = contents(data());
  expect_refused("manual " + quoted(pages), "aligngs-manual.1");
  for (int again = 0; again < 2; ++again) EXPECT_EQ(aligngs("manual " + quoted(root_ / "pages")).status, 0);
}

/// A textured OBJ or USD has files beside it, which the user does not name.
TEST_F(DataLoss, ExportsReplaceNoFileOfOthersBesideTheirs) {
  const fs::path run = root_ / "run";
  ASSERT_EQ(aligngs("train " + quoted(root_ / "made") + " -n 2 -o " + quoted(run)).status, 0);
  ASSERT_EQ(aligngs("mesh " + quoted(run) + " --set mesh.voxel=0.2").status, 0);
  const fs::path models = root_ / "models";
  fs::create_directories(models);
  for (const char* file : {"photo.jpg", "chair.mtl", "table.obj", "lamp.usda"})
    write_file_atomically(models / file, "of somebody");
  const auto theirs = contents(models);
  const auto textured = [&](const char* name) {
    const std::string format = fs::path(name).extension().string().substr(1);
    return "export " + quoted(run) + " -f " + format + " --textured --texture-size 256 -o ";
  };
  for (const char* name : {"photo.obj", "photo.usda", "chair.obj", "table.obj", "lamp.usda"}) {
    const ProcessResult result = aligngs(textured(name) + quoted(models / name));
    EXPECT_EQ(result.status, 2) << name;
    EXPECT_THAT(result.err, HasSubstr("never replaced")) << name;
  }
  EXPECT_TRUE(contents(models) == theirs);
  for (const char* name : {"room.obj", "room.obj", "room.usda", "room.usda"}) {
    const ProcessResult result = aligngs(textured(name) + quoted(root_ / name));
    EXPECT_EQ(result.status, 0) << result.err;
  }
}

}  // namespace
}  // namespace aligngs
