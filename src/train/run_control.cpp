#include "train/run_control.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/error.h"
#include "io/file_system_error.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

constexpr RunControl::Flag kFlags[] = {RunControl::Flag::kPause, RunControl::Flag::kCheckpoint, RunControl::Flag::kStop,
                                       RunControl::Flag::kSnapshot};

const char* name_of(RunControl::Flag flag) {
  switch (flag) {
    case RunControl::Flag::kPause:
      return "pause";
    case RunControl::Flag::kCheckpoint:
      return "checkpoint";
    case RunControl::Flag::kStop:
      return "stop";
    case RunControl::Flag::kSnapshot:
      return "snapshot";
  }
  return "";
}

}  // namespace

fs::path RunControl::file(Flag flag) const { return folder_ / name_of(flag); }

bool RunControl::active() const {
  // A FIFO in its place, or a link to one, is not waited for.
  const int descriptor = open((folder_ / "lock").c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return false;
  // A shared lock is refused while the worker holds its exclusive one; many may ask at a time.
  const bool refused = flock(descriptor, LOCK_SH | LOCK_NB) != 0;
  close(descriptor);
  return refused;
}

void RunControl::ask(Flag flag) const {
  std::error_code error;
  fs::create_directories(folder_, error);
  const int descriptor = open(file(flag).c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW, 0644);
  if (descriptor < 0) {
    throw_resources(file(flag), std::string("cannot be written: ") + std::strerror(errno),
                    "you need write access to the run folder");
  }
  close(descriptor);
}

void RunControl::withdraw(Flag flag) const {
  std::error_code error;
  fs::remove(file(flag), error);
}

bool RunControl::asked(Flag flag) const { return access(file(flag).c_str(), F_OK) == 0; }

bool RunControl::take(Flag flag) const { return asked(flag) && unlink(file(flag).c_str()) == 0; }

RunLock::RunLock(const fs::path& run) : control_(run) {
  std::error_code error;
  fs::create_directories(control_.folder(), error);
  const fs::path path = control_.folder() / "lock";
  descriptor_ = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor_ < 0)
    throw_resources(path, std::string("cannot be opened: ") + std::strerror(errno), remedy_for_write(errno));
  // Somebody who only asks active() holds the lock for a moment: try again before giving up.
  constexpr int kTries = 100;  // half a second: on a busy machine the asker may sleep with the lock in its hands
  for (int i = 0; flock(descriptor_, LOCK_EX | LOCK_NB) != 0; ++i) {
    const int reason = errno;
    if (reason != EWOULDBLOCK && reason != EINTR) break;  // a file system without locks: work without one
    if (i < kTries) {
      usleep(5000);
      continue;
    }
    close(descriptor_);
    throw Error({ErrorKind::kUsage,
                 "another process is working on this run",
                 run,
                 {},
                 "wait until it has ended, or stop it: touch " + control_.file(RunControl::Flag::kStop).string()});
  }
  for (const RunControl::Flag flag : kFlags) control_.withdraw(flag);
}

RunLock::~RunLock() {
  for (const RunControl::Flag flag : kFlags) control_.withdraw(flag);
  close(descriptor_);
}

}  // namespace aligngs
