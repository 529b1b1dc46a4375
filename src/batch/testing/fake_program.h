// For tests: a program that replaces aligngs in a batch, and a batch that uses it. The source's name says how it
// behaves.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "batch/worker.h"
#include "core/log.h"
#include "io/atomic_file.h"

namespace aligngs::test_batch {

namespace fs = std::filesystem;

/// "good": done at once. "broken": status 3 with an error as --json prints it. "slow": waits for SIGTERM, then status
/// 75; done when it is resumed. "killed", "early": end by SIGKILL or by SIGTERM. "meets": leaves a file met.txt where
/// another of its kind works at the same time. Each start is a line of starts.txt: the room and --resume or
/// --overwrite.
inline constexpr const char* kFakeProgram = R"(#!/bin/sh
source=$(basename "$2")
while [ $# -gt 0 ]; do
  case $1 in
    -o) run=$2 ;;
    --resume|--overwrite) mode=$1 ;;
  esac
  shift
done
record() {
  mkdir -p "$run"
  echo "{\"schema\": 1, \"status\": \"$1\", \"stage\": \"$2\", \"version\": \"0\", \"fingerprint\": \"f\"}" >"$run/run.json"
}
echo "$(basename "$run") $mode" >>"$(dirname "$0")/starts.txt"
case $source in
  good*) record done done ;;
  broken*)
    echo '{"error": {"status": 3, "message": "no photos are here", "path": "/p", "field": "f", "remedy": "take some"}}'
    exit 3 ;;
  slow*)
    if [ $mode = --resume ]; then record done done; exit 0; fi
    record running train
    trap 'record stopped train; exit 75' TERM
    while :; do sleep 0.02; done ;;
  killed*) kill -9 $$ ;;
  early*) kill -TERM $$ ;;
  meets*)
    mkdir "$(dirname "$0")/busy" || touch "$(dirname "$0")/met.txt"
    sleep 0.5
    rmdir "$(dirname "$0")/busy"
    record done done ;;
esac
)";

class FakeBatch : public testing::Test {
 protected:
  void SetUp() override {
    set_log_level(LogLevel::kSilent);
    base_ = fs::path(testing::TempDir()) / "fake_batch" / testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(base_);
    fs::create_directories(base_);
    std::ofstream(base_ / "program") << kFakeProgram;
    fs::permissions(base_ / "program", fs::perms::owner_all);
    batch_.list = base_ / "rooms.tsv";
    options_.attempt.program = base_ / "program";
    options_.times = {.renew_seconds = 0.05, .stale_seconds = 60};
  }
  void TearDown() override { set_log_level(LogLevel::kInfo); }

  /// A room named after its source.
  void add(const std::string& source) {
    write_file_atomically(base_ / source / "photo.jpg", source);
    RoomEntry room;
    room.name = room.source = source;
    batch_.rooms.push_back(room);
  }
  BatchFolder folder() const { return BatchFolder(base_ / "out"); }
  WorkerSummary work() {
    folder().prepare(batch_);
    return work_on(BatchFolder(base_ / "out"), batch_, batch_.rooms, options_);
  }
  /// Lines of starts.txt.
  std::vector<std::string> starts() const {
    std::vector<std::string> lines;
    std::ifstream in(base_ / "starts.txt");
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
  }

  fs::path base_;
  Batch batch_;
  WorkerOptions options_;
};

}  // namespace aligngs::test_batch
