#include "cli/report/html_report.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/loss_catalogue.h"
#include "io/atomic_file.h"
#include "io/image_file.h"

namespace aligngs {
namespace {

using testing::HasSubstr;
using testing::Not;

std::filesystem::path fresh_folder() {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "html_report" /
                                       testing::UnitTest::GetInstance()->current_test_info()->name();
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

/// A run of three steps in which these losses act.
std::string report_with(const std::filesystem::path& run, const std::vector<Loss>& acting) {
  std::string events;
  for (int step = 1; step <= 3; ++step) {
    nlohmann::json line = {
        {"step", step}, {"psnr", 20 + step}, {"gaussians", 100}, {"losses", {{"total", 1.0 / step}}}};
    for (const LossRow& row : kLossCatalogue) line["losses"][std::string(row.name)] = 0.0;
    for (const Loss loss : acting) line["losses"][std::string(row_of(loss).name)] = 0.5 / step;
    events += line.dump() + "\n";
  }
  write_file_atomically(run / "events.ndjson", events);
  return html_report(run);
}

TEST(HtmlReport, ChartsEveryLossThatActs) {
  std::vector<Loss> all;
  for (const LossRow& row : kLossCatalogue) all.push_back(row.loss);
  const std::string html = report_with(fresh_folder(), all);
  for (const LossRow& row : kLossCatalogue) EXPECT_THAT(html, HasSubstr(">" + std::string(row.name) + "</text>"));
}

TEST(HtmlReport, LeavesOutLossesThatNeverAct) {
  const std::string html = report_with(fresh_folder(), {Loss::kL1, Loss::kCrease});
  EXPECT_THAT(html, HasSubstr(">crease</text>"));
  EXPECT_THAT(html, Not(HasSubstr(">pearson</text>")));
  EXPECT_THAT(html, Not(HasSubstr("losses on classes")));
}

TEST(HtmlReport, FiguresThatWereNotMeasuredHaveNoCard) {
  const std::string html = report_with(fresh_folder(), {Loss::kL1});
  EXPECT_THAT(html, HasSubstr("PSNR of training views (dB)"));
  EXPECT_THAT(html, Not(HasSubstr("PSNR of test views (dB)")));
  EXPECT_THAT(html, Not(HasSubstr("F-score")));
  EXPECT_THAT(html, HasSubstr("No photo was kept for testing"));
}

TEST(HtmlReport, WithoutTestViewsTrainingViewsAreShown) {
  const std::filesystem::path run = fresh_folder();
  for (const char* kind : {"rgb", "gt"}) {
    std::filesystem::create_directories(run / "renders" / "train" / kind);
    write_png(run / "renders" / "train" / kind / "kitchen_1.png", Image<uint8_t>(4, 3, 3, 128));
  }
  write_report(run);
  const std::string html = html_report(run);
  EXPECT_THAT(html, HasSubstr("Renders of training views"));
  EXPECT_THAT(html, HasSubstr("kitchen_1"));
  EXPECT_TRUE(std::filesystem::exists(run / "overview.jpg"));
}

}  // namespace
}  // namespace aligngs
