// The program itself, started for one room.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace aligngs {

struct RoomCommand {
  std::vector<std::string> words;  ///< the program's path first
  std::filesystem::path folder;    ///< in which it works
  std::filesystem::path out, log;  ///< standard output (replaced) and standard error (appended)
};

/// A child process. It is killed when the object or the process that started it ends: no room is worked on without its
/// lease.
class RoomProcess {
 public:
  /// Error{kResources} when it cannot be started.
  explicit RoomProcess(const RoomCommand& command);
  RoomProcess(RoomProcess&& other) noexcept;
  RoomProcess& operator=(RoomProcess&&) = delete;
  ~RoomProcess();

  /// Whether it has ended. Does not wait.
  bool ended();
  /// After ended(): the exit status, or 128 + signal where a signal ended it.
  int status() const { return status_; }
  /// Asks it to write its checkpoint and to end (SIGTERM).
  void ask_to_stop() const;
  /// Ends it at once and waits for that.
  void kill();

 private:
  pid_t pid_ = 0;  ///< 0: none, or ended
  int status_ = -1;
};

/// Path of the running program.
std::filesystem::path own_program();

}  // namespace aligngs
