#include "priors/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>

#include "core/error.h"
#include "core/stop_signal.h"

extern char** environ;

namespace aligngs {

namespace fs = std::filesystem;

fs::path find_program(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path candidate = fs::path(folder.empty() ? "." : folder) / name;
    if (access(candidate.c_str(), X_OK) == 0 && !fs::is_directory(candidate)) return candidate;
  }
  return {};
}

ChildResult run_child(const std::vector<std::string>& arguments, const fs::path& log,
                      const std::function<void(const std::string&)>& on_line) {
  constexpr size_t kLastCharacters = 2000;
  constexpr int kPollMilliseconds = 100;  // how soon a stop request is seen
  constexpr int kPollsToEnd = 6;          // 0.6 s to end after SIGTERM, well within kGraceSeconds (core/stop_signal.h)
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw_resources({}, std::strerror(errno));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  pid_t child = 0;
  const int failed = posix_spawnp(&child, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  if (failed != 0) {
    close(ends[0]);
    throw Error({ErrorKind::kFailed, "cannot start it: " + std::string(std::strerror(failed)), arguments[0], "",
                 "install it, and see that it is in PATH"});
  }
  std::ofstream out(log, std::ios::app);
  ChildResult result;
  std::string line;
  bool stopped = false;
  int polls_since = 0;
  const auto take = [&] {
    out << line << '\n';
    result.last_lines += line + "\n";
    if (result.last_lines.size() > 2 * kLastCharacters)
      result.last_lines.erase(0, result.last_lines.size() - kLastCharacters);
    if (on_line) on_line(line);
    line.clear();
  };
  for (;;) {
    if (!stopped && stop_requested()) {
      stopped = true;
      kill(child, SIGTERM);
    }
    if (stopped && ++polls_since > kPollsToEnd) {
      kill(child, SIGKILL);
      break;  // its own children may hold the pipe open
    }
    pollfd waiting{ends[0], POLLIN, 0};
    if (poll(&waiting, 1, kPollMilliseconds) <= 0) continue;
    char buffer[4096];
    const ssize_t n = read(ends[0], buffer, sizeof(buffer));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    for (ssize_t i = 0; i < n; ++i) {
      if (buffer[i] == '\n')
        take();
      else
        line += buffer[i];
    }
  }
  if (!line.empty()) take();
  close(ends[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  if (stopped || stop_requested()) {
    throw Error({ErrorKind::kInterrupted,
                 "stopped while " + arguments[0] + " was running",
                 {},
                 "",
                 "run the same command again"});
  }
  if (result.last_lines.size() > kLastCharacters)
    result.last_lines.erase(0, result.last_lines.size() - kLastCharacters);
  return result;
}

}  // namespace aligngs
