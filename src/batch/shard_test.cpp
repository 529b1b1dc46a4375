#include "batch/shard.h"

#include <gmock/gmock.h>

#include <map>

#include "core/error.h"

namespace aligngs {
namespace {

using testing::ElementsAre;

Shard shard_in(const std::map<std::string, std::string>& environment, int count = 0) {
  return shard_from_environment(
      [&](const char* name) {
        const auto it = environment.find(name);
        return it == environment.end() ? nullptr : it->second.c_str();
      },
      count);
}

void expect_part(const Shard& shard, int index, int count) {
  EXPECT_EQ(shard.index, index);
  EXPECT_EQ(shard.count, count);
}

TEST(ShardTest, ByHand) {
  expect_part(parse_shard("2/8"), 2, 8);
  for (const char* wrong : {"0/8", "9/8", "8", "1/", "/8", "a/b", "1/8x", "-1/8", "1/99999999999"})
    EXPECT_THROW(parse_shard(wrong), Error) << wrong;
}

TEST(ShardTest, SlurmCountsFromItsFirstTask) {
  expect_part(shard_in({{"SLURM_ARRAY_TASK_ID", "4"}, {"SLURM_ARRAY_TASK_MIN", "1"}, {"SLURM_ARRAY_TASK_COUNT", "12"}}),
              4, 12);
  expect_part(shard_in({{"SLURM_ARRAY_TASK_ID", "6"},
                        {"SLURM_ARRAY_TASK_MIN", "2"},
                        {"SLURM_ARRAY_TASK_STEP", "2"},
                        {"SLURM_ARRAY_TASK_COUNT", "5"}}),
              3, 5);
}

TEST(ShardTest, ACountByHandMakesNumbersAbsoluteSoThatAnArrayMayHoldSome) {
  expect_part(
      shard_in({{"SLURM_ARRAY_TASK_ID", "7"}, {"SLURM_ARRAY_TASK_MIN", "3"}, {"SLURM_ARRAY_TASK_COUNT", "2"}}, 12), 8,
      12);
  expect_part(shard_in({{"JOB_COMPLETION_INDEX", "0"}}, 3), 1, 3);
}

TEST(ShardTest, AwsTellsItsSize) {
  expect_part(shard_in({{"AWS_BATCH_JOB_ARRAY_INDEX", "2"}, {"AWS_BATCH_JOB_ARRAY_SIZE", "3"}}), 3, 3);
}

TEST(ShardTest, WithoutAnArrayAllRoomsAreOnePart) {
  const Shard shard = shard_in({});
  expect_part(shard, 1, 1);
  EXPECT_EQ(shard.from, "");
}

TEST(ShardTest, WhatDoesNotGoTogetherIsRefused) {
  EXPECT_THROW(shard_in({{"JOB_COMPLETION_INDEX", "0"}}), Error) << "no count";
  EXPECT_THROW(shard_in({{"JOB_COMPLETION_INDEX", "3"}}, 3), Error) << "beyond the count";
  EXPECT_THROW(shard_in({{"SLURM_ARRAY_TASK_ID", "x"}}, 3), Error) << "no number";
}

TEST(ShardTest, PartsHaveEveryRoomOnce) {
  std::vector<RoomEntry> rooms(5);
  for (size_t i = 0; i < rooms.size(); ++i) rooms[i].name = std::string(1, static_cast<char>('a' + i));
  const auto names = [&](int index) {
    std::string text;
    for (const RoomEntry& room : rooms_of_shard(rooms, {index, 3, ""})) text += room.name;
    return text;
  };
  EXPECT_THAT((std::vector<std::string>{names(1), names(2), names(3)}), ElementsAre("ad", "be", "c"));
}

}  // namespace
}  // namespace aligngs
