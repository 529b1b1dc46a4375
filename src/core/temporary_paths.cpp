#include "core/temporary_paths.h"

#include <algorithm>
#include <set>
#include <system_error>

namespace aligngs {

namespace fs = std::filesystem;

namespace {

// Never destroyed: a signal may come while the process is ending.
std::recursive_mutex& mutex() {
  static auto* const mutex = new std::recursive_mutex;
  return *mutex;
}

std::set<fs::path>& paths() {
  static auto* const paths = new std::set<fs::path>;
  return *paths;
}

}  // namespace

fs::path temporary_beside(const fs::path& path, const std::string& suffix) {
  constexpr size_t kLongestName = 255;  // bytes: ext4, XFS, Btrfs, APFS
  std::string name = path.filename().string();
  if (name.size() + suffix.size() > kLongestName) {
    size_t end = kLongestName - std::min(suffix.size(), kLongestName);
    while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xc0) == 0x80) --end;
    name.resize(end);
  }
  return path.parent_path() / (name + suffix);
}

void note_temporary_path(const fs::path& path) {
  const auto lock = hold_temporary_paths();
  paths().insert(path);
}

void forget_temporary_path(const fs::path& path) {
  const auto lock = hold_temporary_paths();
  paths().erase(path);
}

bool is_noted_temporary_path(const fs::path& path) {
  const auto lock = hold_temporary_paths();
  return paths().count(path) > 0;
}

std::unique_lock<std::recursive_mutex> hold_temporary_paths() { return std::unique_lock(mutex()); }

void remove_temporary_paths() {
  mutex().lock();  // for ever
  for (const fs::path& path : paths()) {
    // Another thread may still write into a folder: under another name it finds the folder no more.
    const fs::path moved = temporary_beside(path, ".removed");
    std::error_code error;
    fs::rename(path, moved, error);
    std::error_code ignored;
    fs::remove_all(error ? path : moved, ignored);
  }
}

}  // namespace aligngs
