#include "cli/report/batch_results.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "batch/testing/fake_program.h"

namespace aligngs {
namespace {

using testing::HasSubstr;
using testing::Not;

/// One room with figures, one that failed, one that was never begun.
class BatchResults : public test_batch::FakeBatch {
 protected:
  void SetUp() override {
    FakeBatch::SetUp();
    add("good");
    add("broken");
    work();
    write_file_atomically(folder().run("good") / "metrics.json", R"({"nvs": {"psnr": 21.5}})");
    add("later");
    rooms_ = batch_status(folder(), batch_, options_.times);
  }
  std::vector<RoomStatus> rooms_;
};

TEST_F(BatchResults, CsvHasALineForEveryRoom) {
  const std::string csv = batch_csv(folder(), rooms_);
  EXPECT_THAT(csv, HasSubstr("room,state,attempts,exit_status,message,remedy,retry,psnr,"));
  EXPECT_THAT(csv, HasSubstr("\ngood,done,1,,,,,21.5,"));
  EXPECT_THAT(csv, HasSubstr("\nbroken,failed,1,3,no photos are here,take some,aligngs batch retry "));
  EXPECT_THAT(csv, HasSubstr("\nlater,waiting,0,"));
}

TEST_F(BatchResults, JsonHasFiguresAndFaults) {
  const nlohmann::ordered_json json = batch_json(folder(), rooms_);
  EXPECT_EQ(json["rooms"][0]["figures"]["psnr"], 21.5);
  EXPECT_EQ(json["rooms"][1]["remedy"], "take some");
  EXPECT_EQ(json["rooms"][1]["exit_status"], 3);
  EXPECT_FALSE(json["rooms"][2].contains("figures"));
}

TEST_F(BatchResults, ThePageShowsFailuresBeforeFigures) {
  const std::string page = batch_page(folder(), rooms_);
  EXPECT_THAT(page, HasSubstr("1 of 3 rooms are done"));
  EXPECT_LT(page.find("no photos are here"), page.find("21.5"));
  EXPECT_THAT(page, HasSubstr("<code>" + retry_command(folder(), "broken") + "</code>"));
}

TEST_F(BatchResults, TextOfAFaultIsNoMarkup) {
  rooms_[1].record.message = "<script>, \"and\" more";
  EXPECT_THAT(batch_page(folder(), rooms_), Not(HasSubstr("<script>")));
  EXPECT_THAT(batch_csv(folder(), rooms_), HasSubstr(",\"<script>, \"\"and\"\" more\","));
}

}  // namespace
}  // namespace aligngs
