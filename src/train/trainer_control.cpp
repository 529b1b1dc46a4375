// Requests from outside between two steps: stop, pause, checkpoint, snapshot (run_control.h).
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "core/error.h"
#include "core/log.h"
#include "core/steady_seconds.h"
#include "core/stop_signal.h"
#include "train/live_snapshot.h"
#include "train/trainer.h"

namespace aligngs {
namespace {

constexpr double kLookEvery = 0.1;       // seconds between looks for flags: four file names that mostly do not exist
constexpr double kSnapshotEvery = 2;     // seconds; a picture that changes more often is not seen any better
constexpr double kSnapshotShare = 0.05;  // of the time, at most, goes into snapshots

}  // namespace

void Trainer::stop_here() {
  if (checkpointed_ != state_.iteration) write_state();
  throw Error({ErrorKind::kInterrupted,
               fmt::format("stopped at iteration {} of {}, a checkpoint is written", state_.iteration,
                           in_.config.train.iterations),
               folder_.path(),
               {},
               "resume with: " + in_.resume_command});
}

void Trainer::obey() {
  if (steady_seconds() < look_at_) return;
  obey_once();
  if (control_.asked(RunControl::Flag::kPause)) {
    log_info("paused at iteration {}; remove {} to continue", state_.iteration,
             control_.file(RunControl::Flag::kPause).string());
    record_.status = RunStatus::kPaused;
    record_.updated = utc_now();
    write_run_record(folder_.record(), record_);
    while (control_.asked(RunControl::Flag::kPause)) {
      const double rested = steady_seconds();
      std::this_thread::sleep_for(std::chrono::duration<double>(kLookEvery));
      begun_ += steady_seconds() - rested;  // a rest is no training time
      if (stop_requested()) stop_here();
      obey_once();
    }
    record_.status = RunStatus::kRunning;
    record_.updated = utc_now();
    write_run_record(folder_.record(), record_);
  }
  look_at_ = steady_seconds() + kLookEvery;
}

void Trainer::obey_once() {
  if (control_.take(RunControl::Flag::kStop)) stop_here();
  if (control_.take(RunControl::Flag::kCheckpoint) && checkpointed_ != state_.iteration) write_state();
  if (steady_seconds() >= snapshot_at_ && control_.take(RunControl::Flag::kSnapshot)) publish_snapshot();
}

/// Someone who looks on must never end a training: a full disk is only told.
void Trainer::publish_snapshot() {
  const double begun = steady_seconds();
  try {
    GaussianModel model;
    engine_.store(model);
    write_live_snapshot(folder_, model, in_.labels, pool_);
  } catch (const Error& error) {
    log_warning("no live picture: {}", error.what());
  }
  const double now = steady_seconds();
  snapshot_at_ = now + std::max(kSnapshotEvery, (now - begun) / kSnapshotShare);
}

}  // namespace aligngs
