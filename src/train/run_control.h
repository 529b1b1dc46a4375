// How others speak to a training that is going on: flag files in RUN/control/, looked at between steps.
//
//   touch RUN/control/pause        rest after the next step; remove the file to go on
//   touch RUN/control/checkpoint   write a checkpoint now
//   touch RUN/control/stop         write a checkpoint and end, as Ctrl-C does (status 75)
//   touch RUN/control/snapshot     write RUN/live/scene.ply, a picture of the Gaussians as they are (live_snapshot.h)
//
// The training removes a flag when it has obeyed; all but `pause`. RUN/control/lock is locked while a process works on
// the run, so that flags are not left for nobody and two processes never train one run.
#pragma once

#include <filesystem>

namespace aligngs {

class RunControl {
 public:
  enum class Flag { kPause, kCheckpoint, kStop, kSnapshot };

  explicit RunControl(const std::filesystem::path& run) : folder_(run / "control") {}

  /// Whether a process holds the run's lock: it trains, renders or measures.
  bool active() const;

  /// Error{kResources} when the flag cannot be written.
  void ask(Flag flag) const;
  void withdraw(Flag flag) const;  ///< no error when it is not set
  bool asked(Flag flag) const;
  bool take(Flag flag) const;  ///< asked(), and withdraws it
  std::filesystem::path file(Flag flag) const;
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
};

/// Held by the process that works on a run. Flags that nobody obeyed in time are removed when it begins and ends.
class RunLock {
 public:
  /// Error{kUsage} when another process holds it, Error{kResources} when the folder cannot be written.
  explicit RunLock(const std::filesystem::path& run);
  ~RunLock();
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;

 private:
  RunControl control_;
  int descriptor_ = -1;
};

}  // namespace aligngs
