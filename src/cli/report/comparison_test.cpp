// Two runs side by side: what is equal, what differs, and what makes them hard to compare.
#include "cli/report/comparison.h"

#include <gmock/gmock.h>

#include <cmath>

#include "cli/report/same_room.h"
#include "core/error.h"
#include "io/atomic_file.h"
#include "io/image_file.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class ComparisonTest : public testing::Test {
 protected:
  void SetUp() override { fs::remove_all(root()); }
  static fs::path root() {
    return fs::path(testing::TempDir()) /
           (std::string("comparison_") + testing::UnitTest::GetInstance()->current_test_info()->name());
  }
  static fs::path write_run(const std::string& name, double first_psnr, const std::string& priors = "exact") {
    const fs::path run = root() / name;
    fs::create_directories(run);
    std::string views;
    for (int i = 0; i < 4; ++i) {
      views += std::string(i ? "," : "") + R"({"name": "v)" + std::to_string(i) + R"(", "psnr": )" +
               std::to_string(first_psnr + i) + R"(, "ssim": 0.5})";
    }
    write_file_atomically(run / "metrics.json",
                          R"({"nvs": {"psnr": )" + std::to_string(first_psnr + 1.5) +
                              R"(, "ssim": 0.5, "lpips": null}, "geometry": {"fscore": 0.8, "protocol": "area"},
                              "semantics": null, "priors": ")" +
                              priors + R"(", "per_view": [)" + views + "]}");
    return run;
  }
  static std::vector<RunScores> read(const std::vector<fs::path>& folders) {
    std::vector<RunScores> runs;
    for (const fs::path& f : folders) runs.push_back(read_run_scores(f));
    name_apart(runs);
    return runs;
  }
};

TEST_F(ComparisonTest, ReadsTheFiguresAndKnowsWhatIsMissing) {
  const RunScores run = read_run_scores(write_run("a", 20));
  EXPECT_EQ(run.name, "a");
  EXPECT_DOUBLE_EQ(run[Score::kPsnr], 21.5);
  EXPECT_DOUBLE_EQ(run[Score::kFscore], 0.8);
  EXPECT_TRUE(std::isnan(run[Score::kLpips]));
  EXPECT_TRUE(std::isnan(run[Score::kMiou]));
  EXPECT_EQ(run.views.size(), 4u);
}

TEST_F(ComparisonTest, ARunThatWasNotMeasuredSaysWhatToDo) {
  write_file_atomically(root() / "empty" / "run.json", "{}");
  try {
    read_run_scores(root() / "empty");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("aligngs eval"));
  }
}

TEST_F(ComparisonTest, AFileThatIsNotJsonIsBadInput) {
  write_file_atomically(root() / "bad" / "metrics.json", "{\"nvs\": ");
  EXPECT_THROW(read_run_scores(root() / "bad"), Error);
}

TEST_F(ComparisonTest, AFolderThatIsNoRunSaysWhatItIs) {
  const auto refusal = [](const fs::path& folder) -> std::string {
    try {
      read_run_scores(folder);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  write_file_atomically(root() / "scene" / "scene.json", "{}");
  EXPECT_THAT(refusal(root() / "absent"), HasSubstr("no such folder"));
  EXPECT_THAT(refusal(root() / "scene"), HasSubstr("scene folder"));
}

TEST_F(ComparisonTest, AListIsNoMetrics) {
  write_file_atomically(root() / "list" / "metrics.json", "[]");
  try {
    read_run_scores(root() / "list");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("is JSON, but no object"));
  }
}

TEST_F(ComparisonTest, FewSharedViewsHaveNoInterval) {
  auto runs = read({write_run("a", 20), write_run("b", 20.5)});
  runs[1].views.resize(2);
  const std::string text = comparison_text(runs);
  EXPECT_THAT(text, HasSubstr("b against a: PSNR (dB) +0.50 over 2 shared test views (no interval below 3)\n"));
  EXPECT_THAT(text, Not(HasSubstr("inside the noise")));
  EXPECT_THAT(comparison_page(runs), HasSubstr("no interval below 3 views"));
}

TEST_F(ComparisonTest, ViewsOfDifferentRoomsHaveNoPairs) {
  const fs::path a = write_run("a", 20), b = write_run("b", 21), c = write_run("c", 22);
  Image<uint8_t> dark(32, 24, 3), light(32, 24, 3), same(16, 12, 3);
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 32; ++x) {
      for (int channel = 0; channel < 3; ++channel) {
        dark.at(x, y, channel) = static_cast<uint8_t>(4 * x);
        light.at(x, y, channel) = static_cast<uint8_t>(255 - 4 * y);
        same.at(x / 2, y / 2, channel) = static_cast<uint8_t>(4 * x);
      }
    }
  }
  for (const auto& [run, photo] : {std::pair{a, dark}, {b, light}, {c, same}}) {
    fs::create_directories(run / "renders" / "test" / "gt");
    for (const char* view : {"v0", "v1", "v2"})
      write_png(run / "renders" / "test" / "gt" / (std::string(view) + ".png"), photo);
  }
  auto runs = read({a, b, c});
  mark_other_rooms(runs);
  EXPECT_TRUE(runs[1].other_room);
  EXPECT_FALSE(runs[2].other_room) << "the same photos in another size";
  EXPECT_EQ(view_difference(runs[0], runs[1]).pairs, 0u);
  EXPECT_EQ(view_difference(runs[0], runs[2]).pairs, 4u);
  EXPECT_THAT(comparison_text(runs), HasSubstr("b against a: different rooms"));
  EXPECT_THAT(comparison_warnings(runs), testing::Contains(HasSubstr("different rooms")));
}

TEST_F(ComparisonTest, TextHasARowPerRunAndTheDifferenceOverSharedViews) {
  const std::string text = comparison_text(read({write_run("a", 20), write_run("b", 20.5)}));
  EXPECT_THAT(text, HasSubstr("21.50"));
  EXPECT_THAT(text, HasSubstr("22.00"));
  EXPECT_THAT(text, HasSubstr("b against a: PSNR (dB) +0.50, 95 % interval +0.50 to +0.50 over 4 shared test views\n"));
  EXPECT_THAT(
      text,
      HasSubstr(
          "b against a: SSIM +0.000, 95 % interval +0.000 to +0.000 over 4 shared test views (inside the noise)\n"));
  EXPECT_THAT(text, Not(HasSubstr("label accuracy"))) << "no view has labels";
  EXPECT_THAT(text, Not(HasSubstr("LPIPS"))) << "no run has it";
}

TEST_F(ComparisonTest, CsvKeepsEveryColumnAndLeavesHolesEmpty) {
  const std::string csv = comparison_csv(read({write_run("a, b", 20)}));
  EXPECT_THAT(csv, HasSubstr("run,psnr,psnr_fitted,psnr_pose,psnr_interpolating,psnr_extrapolating,ssim,lpips,"));
  EXPECT_THAT(csv, HasSubstr("\"a, b\",21.5,,,,,0.5,,"));
}

TEST_F(ComparisonTest, EqualNamesAreToldApartByTheirPath) {
  const auto runs = read({write_run("x/run", 20), write_run("y/run", 21)});
  EXPECT_THAT(runs[0].name, HasSubstr("x/run"));
  EXPECT_THAT(runs[1].name, HasSubstr("y/run"));
}

TEST_F(ComparisonTest, WarnsOfOtherViewsAndSimulatedPriors) {
  auto runs = read({write_run("a", 20), write_run("b", 21)});
  EXPECT_THAT(comparison_warnings(runs), IsEmpty());
  runs[1].views.pop_back();
  runs[1].protocol = "vertices";
  runs[1].priors = "simulated teacher";
  EXPECT_THAT(comparison_warnings(runs),
              ElementsAre(HasSubstr("different test views"), HasSubstr("vertices"), HasSubstr("simulated in: b")));
}

TEST_F(ComparisonTest, PageShowsPhotoAndRendersAndMarksTheBest) {
  const fs::path a = write_run("a", 20), b = write_run("<b>", 21);
  Image<uint8_t> picture(8, 6, 3);
  for (const fs::path& run : {a, b}) {
    for (const char* kind : {"gt", "rgb"}) {
      fs::create_directories(run / "renders" / "test" / kind);
      write_png(run / "renders" / "test" / kind / "v0.png", picture);
    }
  }
  const std::string page = comparison_page(read({a, b}));
  EXPECT_THAT(page, HasSubstr("&lt;b&gt;"));
  EXPECT_THAT(page, Not(HasSubstr("<b>")));
  EXPECT_THAT(page, HasSubstr("<td class=\"best\">22.50</td>"));
  size_t images = 0;
  for (size_t at = page.find("<img"); at != std::string::npos; at = page.find("<img", at + 1)) ++images;
  EXPECT_EQ(images, 3u) << "one photo, two renders";
}

}  // namespace
}  // namespace aligngs
