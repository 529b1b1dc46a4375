// Starts the program under test, looks on while it works, and sends it signals.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace aligngs::testing_support {

/// Asks every 20 ms whether `condition` holds; false when it does not within `seconds`.
inline bool wait_until(const std::function<bool()>& condition, double seconds) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return true;
}

/// One `aligngs ARGUMENTS...` that runs. Killed by the destructor where it has not ended.
class StartedProcess {
 public:
  /// `ignored`: a signal that it is started with ignored, as nohup does; 0: none.
  StartedProcess(const std::vector<std::string>& arguments, const std::filesystem::path& scratch, int ignored = 0) {
    std::filesystem::create_directories(scratch);
    err_file_ = scratch / "stderr.txt";
    std::filesystem::remove(err_file_);  // of a process before: one that a signal ends at once writes none
    std::vector<std::string> words = {ALIGNGS_PROGRAM};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const std::string err = err_file_.string(), out = (scratch / "stdout.txt").string();
    pid_ = fork();
    if (pid_ != 0) return;
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) ::signal(signal, signal == ignored ? SIG_IGN : SIG_DFL);
    for (const auto& [file, descriptor] : {std::pair{&out, STDOUT_FILENO}, std::pair{&err, STDERR_FILENO}}) {
      const int opened = open(file->c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
      if (opened < 0 || dup2(opened, descriptor) < 0) _exit(126);
    }
    execv(argv[0], argv.data());
    _exit(127);
  }
  ~StartedProcess() {
    if (ended_) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  StartedProcess(const StartedProcess&) = delete;
  StartedProcess& operator=(const StartedProcess&) = delete;

  void send(int signal) const { kill(pid_, signal); }
  bool catches(int signal) const { return has("SigCgt:", signal); }
  bool ignores(int signal) const { return has("SigIgn:", signal); }
  /// The exit status, 128 + signal where one ended it, or -1 when it goes on for more than `seconds`.
  int wait(double seconds) {
    int status = 0;
    if (!ended_ && !wait_until([&] { return waitpid(pid_, &status, WNOHANG) == pid_; }, seconds)) return -1;
    ended_ = true;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  std::string err() const {
    std::ostringstream text;
    text << std::ifstream(err_file_).rdbuf();
    return text.str();
  }

 private:
  /// Whether a mask of /proc/PID/status has the signal.
  bool has(const std::string& mask, int signal) const {
    std::ifstream status("/proc/" + std::to_string(pid_) + "/status");
    for (std::string line; std::getline(status, line);) {
      if (line.rfind(mask, 0) == 0)
        return (std::stoull(line.substr(mask.size()), nullptr, 16) >> (signal - 1) & 1) != 0;
    }
    return false;
  }

  std::filesystem::path err_file_;
  pid_t pid_ = 0;
  bool ended_ = false;
};

}  // namespace aligngs::testing_support
