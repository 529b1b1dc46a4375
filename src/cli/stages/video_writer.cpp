#include "cli/stages/video_writer.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>
#include <vector>

#include "core/error.h"
#include "core/stop_signal.h"
#include "core/temporary_paths.h"
#include "io/abandoned_paths.h"
#include "io/atomic_file.h"
#include "io/drawn_picture.h"
#include "io/file_system_error.h"
#include "io/output_place.h"
#include "priors/child_process.h"

extern char** environ;

namespace aligngs {

namespace fs = std::filesystem;

namespace {

constexpr const char* kProgram = "ffmpeg";
constexpr const char* kVideoQuality = "18";          // constant rate factor of x264: no loss that is seen
constexpr uint64_t kLongestLog = uint64_t(1) << 20;  // bytes
constexpr size_t kToldBytes = 400;                   // of what ffmpeg said last

std::vector<std::string> command_of(const fs::path& file, int width, int height, double rate) {
  return {kProgram,
          "-hide_banner",
          "-loglevel",
          "error",
          "-xerror",  // without it a failure to finish the file, as on a full disk, ends with status 0
          "-y",
          "-f",
          "rawvideo",
          "-pixel_format",
          "rgb24",
          "-video_size",
          fmt::format("{}x{}", width, height),
          "-framerate",
          fmt::format("{}", rate),
          "-i",
          "pipe:0",
          "-c:v",
          "libx264",
          "-preset",
          "medium",
          "-crf",
          kVideoQuality,
          "-pix_fmt",
          "yuv420p",
          "-movflags",
          "+faststart",
          "-metadata",
          std::string("comment=") + kDrawnMark,
          "-f",
          "mp4",
          file.string()};
}

}  // namespace

bool can_write_video() { return !find_program(kProgram).empty(); }

VideoWriter::VideoWriter(fs::path file, int width, int height, double rate) : file_(real_place(file)) {
  std::error_code error;
  fs::create_directories(file_.parent_path(), error);
  if (error)
    throw_resources(file_, "the folder cannot be created: " + error.message(), remedy_for_write(error.value()));
  remove_abandoned(file_);
  temporary_ = temporary_beside(file_, ".tmp-" + std::to_string(::getpid()));
  log_ = temporary_beside(file_, ".tmp-" + std::to_string(::getpid()) + ".log");
  note_temporary_path(temporary_);
  note_temporary_path(log_);
  const int log = open(log_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (log < 0) {
    const int code = errno;
    end();
    throw_resources(file_, "cannot create the file: " + std::string(std::strerror(code)), remedy_for_write(code));
  }
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) throw_resources({}, std::strerror(errno));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, log, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  posix_spawnattr_t attributes;  // Ctrl-C is for this program, which then ends ffmpeg
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  posix_spawnattr_setpgroup(&attributes, 0);
  std::vector<std::string> words = command_of(temporary_, width, height, rate);
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const int failed = posix_spawnp(&child_, argv[0], &actions, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  close(log);
  to_child_ = ends[0];
  if (failed == 0) return;
  child_ = -1;
  end();
  throw Error({ErrorKind::kFailed,
               "ffmpeg cannot be started: " + std::string(std::strerror(failed)),
               file_,
               {},
               "see that the folder can be written to"});
}

VideoWriter::~VideoWriter() { end(); }

void VideoWriter::add(const Image<uint8_t>& picture) {
  const uint8_t* data = picture.data.data();
  for (size_t left = picture.data.size(); left > 0;) {
    const ssize_t sent = send(to_child_, data, left, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) fail();
    data += sent;
    left -= static_cast<size_t>(sent);
  }
}

void VideoWriter::commit() {
  close(to_child_);
  to_child_ = -1;
  if (wait() != 0) fail();
  stop_if_requested();
  const auto lock = hold_temporary_paths();
  std::error_code error;
  fs::rename(temporary_, file_, error);
  if (error)
    throw_resources(file_, "the video cannot take its place: " + error.message(), remedy_for_write(error.value()));
  forget_temporary_path(temporary_);
  temporary_.clear();
}

int VideoWriter::wait() {
  int status = 0;
  while (child_ > 0 && waitpid(child_, &status, 0) < 0 && errno == EINTR) {
  }
  child_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

void VideoWriter::fail() {
  if (to_child_ >= 0) close(to_child_);
  to_child_ = -1;
  wait();
  refuse_full_disk(file_.parent_path());
  std::error_code error;
  std::string told = fs::exists(log_, error) ? read_file(log_, kLongestLog) : std::string();
  if (told.size() > kToldBytes) told.erase(0, told.size() - kToldBytes);
  while (!told.empty() && told.back() == '\n') told.pop_back();
  throw Error({ErrorKind::kFailed,
               "ffmpeg has ended: " + told,
               file_,
               {},
               "name a folder instead of a video, and make the video from its pictures"});
}

void VideoWriter::end() {
  if (to_child_ >= 0) close(to_child_);
  to_child_ = -1;
  if (child_ > 0) kill(child_, SIGKILL);
  wait();
  std::error_code ignored;  // nothing to be done about a left-over while another error may be on its way
  for (const fs::path& path : {temporary_, log_}) {
    if (path.empty()) continue;
    fs::remove(path, ignored);
    forget_temporary_path(path);
  }
}

}  // namespace aligngs
