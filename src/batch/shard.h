// The part of a list that one worker takes, given by hand or by what a cluster tells each task of an array.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "batch/room_list.h"

namespace aligngs {

struct Shard {
  int index = 1;  ///< from 1 to count
  int count = 1;
  std::string from;  ///< "--shard", or the variable that tells it; empty: all rooms, none was given
};

/// "2/8". Error{kUsage} for anything else than 1/N to N/N.
Shard parse_shard(const std::string& text);

/// The shard of SLURM_ARRAY_TASK_ID, JOB_COMPLETION_INDEX or AWS_BATCH_JOB_ARRAY_INDEX, in this order. `get` reads a
/// variable: null without it.
/// Numbers are 0 to count - 1 where `count` is given. Without it (0) Slurm's and AWS's variables tell first number,
/// step and count, and Kubernetes tells none. Error{kUsage} for values that do not go together.
Shard shard_from_environment(const std::function<const char*(const char*)>& get, int count);

/// Every count-th room from the index-th, so that neighbours in the list, which tend to be alike, go to different
/// workers.
std::vector<RoomEntry> rooms_of_shard(const std::vector<RoomEntry>& rooms, const Shard& shard);

}  // namespace aligngs
