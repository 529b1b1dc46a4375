// Texts for people: errors, durations, sizes and budgets.
#include <gmock/gmock.h>

#include "core/error.h"
#include "core/memory_budget.h"
#include "core/progress.h"

namespace aligngs {
namespace {

using testing::HasSubstr;

TEST(Error, SaysFileFieldAndRemedy) {
  try {
    throw_bad_input("scene/split.json", "train[2]", "there is no view called x", "use the stem of an image");
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_status(), 3);
    EXPECT_STREQ(error.what(),
                 "scene/split.json: train[2]: there is no view called x\n  remedy: use the stem of an image");
  }
}

TEST(Error, KindIsTheExitStatus) {
  EXPECT_EQ(Error({ErrorKind::kUsage, "x", {}, {}, {}}).exit_status(), 2);
  EXPECT_EQ(Error({ErrorKind::kResources, "x", {}, {}, {}}).exit_status(), 5);
  EXPECT_EQ(Error({ErrorKind::kInterrupted, "x", {}, {}, {}}).exit_status(), 75);
}

TEST(Format, DurationsAndBytes) {
  EXPECT_EQ(format_duration(65.4), "1:05");
  EXPECT_EQ(format_duration(3723), "1:02:03");
  EXPECT_EQ(format_bytes(999), "999 B");
  EXPECT_EQ(format_bytes(12'345'678), "12.3 MB");
}

TEST(MemoryBudget, RefusesWithTheSumShown) {
  MemoryBudget budget(1000);
  budget.add("Gaussians", 700);
  EXPECT_NO_THROW(budget.require("training", "use fewer Gaussians"));
  budget.add("views", 400);
  try {
    budget.require("training", "use fewer Gaussians");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kResources);
    EXPECT_THAT(error.what(), HasSubstr("1.1 kB"));
    EXPECT_THAT(error.what(), HasSubstr("Gaussians"));
    EXPECT_THAT(error.what(), HasSubstr("use fewer Gaussians"));
  }
}

TEST(MemoryBudget, KnowsTheMachine) {
  EXPECT_GT(available_memory_bytes(), 0u);
  EXPECT_GT(peak_memory_bytes(), 0u);
}

}  // namespace
}  // namespace aligngs
