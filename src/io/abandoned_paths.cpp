#include "io/abandoned_paths.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <csignal>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "core/log.h"
#include "core/temporary_paths.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kTemporary = ".tmp-", kWork = ".work-", kOld = ".old", kVideoLog = ".log",
                           kRemoved = ".removed";

/// The end of a temporary name.
struct TemporarySuffix {
  std::string text;      ///< without kRemoved
  pid_t process = 0;     ///< positive
  bool removed = false;  ///< it was being removed (remove_temporary_paths())
};

/// A number that this program writes: digits without a leading zero, unless it is 0. Reads on behind it.
std::optional<unsigned> take_number(std::string_view& text) {
  unsigned value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const auto digits = static_cast<size_t>(end - text.data());
  if (error != std::errc() || (text.front() == '0' && digits > 1)) return std::nullopt;
  text.remove_prefix(digits);
  return value;
}

std::optional<TemporarySuffix> suffix_of(std::string_view name) {
  TemporarySuffix found;
  if (name.ends_with(kRemoved)) {
    found.removed = true;
    name.remove_suffix(kRemoved.size());
  }
  size_t begin = name.rfind(kTemporary);
  const bool work = begin == std::string_view::npos;
  if (work) begin = name.rfind(kWork);
  if (begin == std::string_view::npos || begin == 0) return std::nullopt;
  found.text = name.substr(begin);
  std::string_view rest = name.substr(begin + (work ? kWork : kTemporary).size());
  const auto process = take_number(rest);
  if (!process || *process == 0 || *process > unsigned(std::numeric_limits<pid_t>::max())) return std::nullopt;
  found.process = static_cast<pid_t>(*process);
  if (work) return rest.empty() ? std::optional(found) : std::nullopt;
  if (rest.starts_with('-')) {
    rest.remove_prefix(1);
    return take_number(rest) && rest.empty() ? std::optional(found) : std::nullopt;
  }
  return rest.empty() || rest == kOld || rest == kVideoLog ? std::optional(found) : std::nullopt;
}

bool is_for(const fs::path& path, const TemporarySuffix& suffix, const fs::path& target) {
  fs::path name = temporary_beside(target, suffix.text);
  if (suffix.removed) name = temporary_beside(name, std::string(kRemoved));
  return name.filename() == path.filename();
}

/// While one lives and holds, nobody else takes the path for abandoned.
class AbandonedLock {
 public:
  explicit AbandonedLock(const fs::path& path) {
    struct stat status {};
    if (::lstat(path.c_str(), &status) != 0) return;
    const bool folder = S_ISDIR(status.st_mode);
    if (!folder && !S_ISREG(status.st_mode)) return;  // this program makes no such thing
    // Network file systems lock for writing only what is open for writing.
    descriptor_ = ::open(path.c_str(), (folder ? O_RDONLY | O_DIRECTORY : O_RDWR) | O_CLOEXEC | O_NOFOLLOW);
    holds_ = descriptor_ >= 0 && ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0;
  }
  ~AbandonedLock() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  AbandonedLock(const AbandonedLock&) = delete;
  AbandonedLock& operator=(const AbandonedLock&) = delete;
  bool holds() const { return holds_; }

 private:
  int descriptor_ = -1;
  bool holds_ = false;
};

/// In a container every program may have the id 1. A path of this id is of a former process where this one has not
/// noted it.
bool is_dead(pid_t process, const fs::path& path) {
  if (process == ::getpid()) return !is_noted_temporary_path(path);
  return ::kill(process, 0) != 0 && errno == ESRCH;
}

void remove_if_abandoned(const fs::path& path, const TemporarySuffix& suffix) {
  if (!is_dead(suffix.process, path)) return;
  const AbandonedLock lock(path);
  if (!lock.holds()) return;
  std::error_code error;
  const bool old = !suffix.removed && suffix.text.ends_with(kOld);
  const std::string name = path.filename().string();
  const fs::path target = path.parent_path() / name.substr(0, name.size() - suffix.text.size());
  if (old && !fs::exists(fs::symlink_status(target, error))) {
    fs::rename(path, target, error);
    if (!error) log_info("{}: put back, as a killed command left it aside", target.string());
    return;
  }
  fs::remove_all(path, error);
  if (!error) log_info("{}: removed, as a killed command left it", path.string());
}

struct Candidate {
  fs::path path;
  TemporarySuffix suffix;
};

std::vector<Candidate> candidates_in(const fs::path& folder) {
  std::vector<Candidate> found;
  std::error_code error;
  fs::directory_iterator entry(folder.empty() ? fs::path(".") : folder, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    const fs::path name = entry->path().filename();
    if (auto suffix = suffix_of(name.string())) found.push_back({folder / name, std::move(*suffix)});
  }
  return found;
}

void remove_those_of(const fs::path& target, const std::vector<Candidate>& candidates) {
  for (const Candidate& candidate : candidates) {
    if (is_for(candidate.path, candidate.suffix, target)) remove_if_abandoned(candidate.path, candidate.suffix);
  }
}

}  // namespace

bool is_temporary_name(const std::string& name) { return suffix_of(name).has_value(); }

void lock_temporary(int descriptor) {
  if (descriptor >= 0) (void)::flock(descriptor, LOCK_EX | LOCK_NB);
}

TemporaryFolderLock::TemporaryFolderLock(const fs::path& folder)
    : descriptor_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  lock_temporary(descriptor_);
}

TemporaryFolderLock::~TemporaryFolderLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void remove_abandoned(const fs::path& target) { remove_those_of(target, candidates_in(target.parent_path())); }

void remove_abandoned_file(const fs::path& target) {
  static std::mutex mutex;
  static std::map<fs::path, std::vector<Candidate>> seen;
  const std::lock_guard lock(mutex);
  const auto [folder, first] = seen.try_emplace(target.parent_path());
  if (first) folder->second = candidates_in(folder->first);
  remove_those_of(target, folder->second);
}

void remove_abandoned_in(const fs::path& folder) {
  for (const Candidate& candidate : candidates_in(folder)) remove_if_abandoned(candidate.path, candidate.suffix);
}

}  // namespace aligngs
