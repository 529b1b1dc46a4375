// For tests: runs that are killed in the middle of a step and go on.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "io/atomic_file.h"
#include "train/run_folder.h"
#include "train/testing/watched_engine.h"
#include "train/train_run.h"

namespace aligngs::test_train {

/// An engine that dies in the middle of a step.
inline EngineFactory engine_killed_at(int64_t step) {
  return [step](int threads) { return std::make_unique<WatchedEngine>(make_cpu_engine(threads), killed_at(step)); };
}

/// `make` gives the options of a run by its name. Killed and resumed, such a run must end with the very Gaussians of
/// `whole`, which has ended. `compare` looks at what else must be equal; `places` are the steps in which runs are
/// killed.
inline void expect_resumes(const TrainOptions& whole, const std::function<TrainOptions(const std::string&)>& make,
                           const std::function<void(const TrainOptions&)>& compare = {},
                           const std::vector<int64_t>& places = {5, 16, 37}) {
  for (const int64_t at : places) {
    TrainOptions o = make(whole.run.filename().string() + std::to_string(at));
    EXPECT_THROW(train_run(o, engine_killed_at(at)), Killed);
    o.resume = true;
    train_run(o);
    EXPECT_TRUE(read_file(RunFolder(o.run).scene_ply()) == read_file(RunFolder(whole.run).scene_ply()))
        << o.run << " killed at " << at;
    if (compare) compare(o);
  }
}

}  // namespace aligngs::test_train
