// For tests: runs on a small scene that is written once, with an engine that computes nothing.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "core/error.h"
#include "core/log.h"
#include "core/stop_signal.h"
#include "io/atomic_file.h"
#include "scene/testing/scene_folder.h"
#include "train/run_folder.h"
#include "train/run_record.h"
#include "train/testing/fake_engine.h"
#include "train/train_run.h"

namespace aligngs::test_train {

namespace fs = std::filesystem;

class RunOnFakeEngine : public testing::Test {
 protected:
  void SetUp() override {
    set_log_level(LogLevel::kSilent);
    clear_stop_request();
    // Written once per process, then copied: writing flushes every file to disk.
    static const fs::path original = test_scene::write_scene("original");
    base_ = test_scene::fresh_folder("base");
    scene_ = base_ / "scene";
    fs::create_directories(base_);
    fs::copy(original, scene_, fs::copy_options::recursive);
  }
  void TearDown() override {
    clear_stop_request();
    set_log_level(LogLevel::kInfo);
  }

  TrainOptions options(const std::string& run, int64_t iterations = 30) const {
    TrainOptions o;
    o.scene = scene_;
    o.run = base_ / "runs" / run;
    o.config.iterations = iterations;
    o.config.sets = {"checkpoint.every=9", "train.log_every=5", "densify.residual_quantile=0",
                     "densify.unsupported_min=0"};
    o.command_line = "aligngs train";
    o.progress.enabled = false;
    o.threads = 1;
    return o;
  }

  /// Trains with a FakeEngine that is stopped as kill -9 would: nothing is written after iteration `kill_at`.
  struct Killed {};
  static EngineFactory engine_killed_at(int64_t kill_at) {
    return [kill_at](int) {
      auto engine = std::make_unique<FakeEngine>();
      engine->before_step = [kill_at](int64_t step) -> NonFinite {
        if (step == kill_at) throw Killed{};
        return {};
      };
      return engine;
    };
  }
  static EngineFactory plain_engine() { return engine_killed_at(-1); }

  static std::string ply(const TrainOptions& o) { return read_file(RunFolder(o.run).scene_ply()); }
  static RunRecord record(const TrainOptions& o) { return read_run_record(RunFolder(o.run).record()); }
  static ErrorKind kind_of(const std::function<void()>& action) {
    try {
      action();
    } catch (const Error& e) {
      return e.kind();
    }
    ADD_FAILURE() << "no error was thrown";
    return ErrorKind::kFailed;
  }

  fs::path scene_, base_;
};

}  // namespace aligngs::test_train
