#include "edit/edit_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/error.h"
#include "core/log.h"
#include "core/stop_signal.h"
#include "io/json_text.h"
#include "train/run_record.h"

namespace aligngs {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

namespace {

constexpr size_t kLongestRecord = 4096;         // bytes that are read of the holder's record
constexpr size_t kLongestDoing = 200;           // bytes of the holder's edit in the message
constexpr std::chrono::milliseconds kPoll(50);  // between two tries

std::string host_name() {
  char name[256] = {};
  return gethostname(name, sizeof name - 1) == 0 ? name : "unknown";
}

std::string record_text(std::string_view doing) {
  return json_document(Json{{"pid", getpid()},
                            {"host", host_name()},
                            {"since", utc_now()},
                            {"doing", std::string(doing.substr(0, kLongestDoing))}});
}

/// "process 4711 on host lab since 2026-11-21T00:13:21Z (delete bed)".
std::string holder_of(int descriptor) {
  std::string text(kLongestRecord, '\0');
  const ssize_t read = pread(descriptor, text.data(), text.size(), 0);
  text.resize(read > 0 ? static_cast<size_t>(read) : 0);
  const Json record = parse_ordered_json(text);
  // The holder locks the file first and writes its record then.
  if (!record.is_object() || !record.contains("pid") || !record["pid"].is_number_integer()) return "another process";
  const auto field = [&](const char* name) {
    const auto it = record.find(name);
    return it != record.end() && it->is_string() ? it->get<std::string>() : std::string("unknown");
  };
  return fmt::format("process {} on host {} since {} ({})", record["pid"].get<int64_t>(), field("host"), field("since"),
                     field("doing"));
}

}  // namespace

fs::path edit_lock_file(const fs::path& run) { return run / "control" / "edit.lock"; }

EditLock::EditLock(const fs::path& run, std::string_view doing, double patience) {
  const fs::path path = edit_lock_file(run);
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  descriptor_ = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor_ < 0) {
    throw_resources(path, std::string("cannot be opened: ") + std::strerror(errno),
                    "you need write access to the run folder");
  }
  const Clock::time_point end =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(patience));
  bool told = false;
  try {
    while (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      const int reason = errno;
      if (reason != EWOULDBLOCK && reason != EINTR) {
        log_warning("{}: this file system has no locks ({}); edit this run from one place at a time", path.string(),
                    std::strerror(reason));
        break;
      }
      if (Clock::now() >= end) {
        throw Error({ErrorKind::kUsage,
                     fmt::format("the run is being edited by {}; it did not end within {:g} s", holder_of(descriptor_),
                                 patience),
                     run,
                     {},
                     "try again when that edit has ended, or end that process"});
      }
      if (!told) log_info("waiting for {}, which edits this run", holder_of(descriptor_));
      told = true;
      stop_if_requested();
      std::this_thread::sleep_for(kPoll);
    }
    // The lock holds without the record, which only tells others who has it. An undo must work on a full disk.
    const std::string record = record_text(doing);
    if (ftruncate(descriptor_, 0) != 0 ||
        pwrite(descriptor_, record.data(), record.size(), 0) != static_cast<ssize_t>(record.size()))
      log_debug("{}: cannot be written: {}", path.string(), std::strerror(errno));
  } catch (...) {
    close(descriptor_);
    throw;
  }
}

EditLock::~EditLock() {
  // The file stays: removing it would let a third process lock a new file while a waiting one gets this one.
  [[maybe_unused]] const int emptied = ftruncate(descriptor_, 0);
  close(descriptor_);
}

}  // namespace aligngs
