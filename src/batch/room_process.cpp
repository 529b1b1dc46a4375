#include "batch/room_process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/error.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

constexpr int kCannotStart = 127;  // as shells have it

int open_or_throw(const fs::path& file, int flags) {
  const int descriptor = open(file.c_str(), flags | O_CREAT | O_WRONLY | O_CLOEXEC, 0644);
  if (descriptor < 0) throw_resources(file, std::string("cannot be opened: ") + std::strerror(errno));
  return descriptor;
}

}  // namespace

RoomProcess::RoomProcess(const RoomCommand& command) {
  std::vector<char*> argv;
  for (const std::string& word : command.words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  const int out = open_or_throw(command.out, O_TRUNC), log = open_or_throw(command.log, O_APPEND),
            in = open("/dev/null", O_RDONLY | O_CLOEXEC);
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ == 0) {  // nothing but what signal-safety(7) allows: other threads may hold locks
    ::signal(SIGPIPE, SIG_DFL);
    if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || getppid() != parent) _exit(kCannotStart);
    if (dup2(in, STDIN_FILENO) < 0 || dup2(out, STDOUT_FILENO) < 0 || dup2(log, STDERR_FILENO) < 0) _exit(kCannotStart);
    if (chdir(command.folder.c_str()) != 0) _exit(kCannotStart);
    execv(argv[0], argv.data());
    _exit(kCannotStart);
  }
  const int reason = errno;
  for (const int descriptor : {in, out, log}) close(descriptor);
  if (pid_ < 0) {
    pid_ = 0;
    throw_resources(command.words[0], std::string("cannot be started: ") + std::strerror(reason), "use fewer --jobs");
  }
}

RoomProcess::RoomProcess(RoomProcess&& other) noexcept : pid_(other.pid_), status_(other.status_) { other.pid_ = 0; }

RoomProcess::~RoomProcess() { kill(); }

bool RoomProcess::ended() {
  int status = 0;
  if (pid_ == 0) return true;
  if (waitpid(pid_, &status, WNOHANG) != pid_) return false;
  pid_ = 0;
  status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return true;
}

void RoomProcess::ask_to_stop() const {
  if (pid_ > 0) ::kill(pid_, SIGTERM);
}

void RoomProcess::kill() {
  if (pid_ == 0) return;
  ::kill(pid_, SIGKILL);
  int status = 0;
  while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  pid_ = 0;
  status_ = 128 + SIGKILL;
}

fs::path own_program() {
  std::error_code error;
  const fs::path path = fs::read_symlink("/proc/self/exe", error);
  if (error) throw_resources("/proc/self/exe", "cannot be read: " + error.message(), "mount /proc");
  return path;
}

}  // namespace aligngs
