#include "io/folder_copy.h"

#include <fcntl.h>
#include <unistd.h>

#include "io/file_system_error.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

enum class Way { kCopy, kHardLink };

void copy_entry(const fs::path& from, const fs::path& to, CopiedLinks links, Way way, std::error_code& error) {
  const fs::file_status status =
      links == CopiedLinks::kKept ? fs::symlink_status(from, error) : fs::status(from, error);
  if (error) return;
  if (fs::is_symlink(status)) return fs::copy_symlink(from, to, error);
  if (fs::is_directory(status)) {
    fs::create_directory(to, error);  // with the rights of new folders, whatever those of the old one
    for (fs::directory_iterator entry(from, error), end; !error && entry != end; entry.increment(error)) {
      copy_entry(entry->path(), to / entry->path().filename(), links, way, error);
      if (error) return;
    }
    return;
  }
  if (!fs::is_regular_file(status)) {
    error = std::make_error_code(std::errc::not_supported);
  } else if (way == Way::kHardLink) {
    fs::create_hard_link(from, to, error);
  } else if (fs::copy_file(from, to, error)) {
    fs::permissions(to, fs::perms::owner_write, fs::perm_options::add, error);
  }
}

}  // namespace

void copy_folder(const fs::path& from, const fs::path& to, CopiedLinks links, std::error_code& error) {
  error.clear();
  copy_entry(from, to, links, Way::kCopy, error);
  error = cause_of_write(error, to);
}

void link_folder(const fs::path& from, const fs::path& to, std::error_code& error) {
  error.clear();
  copy_entry(from, to, CopiedLinks::kKept, Way::kHardLink, error);
}

fs::path first_protected_folder(const fs::path& folder) {
  const auto is_protected = [](const fs::path& place) {
    return ::faccessat(AT_FDCWD, place.c_str(), W_OK | X_OK, AT_EACCESS) != 0;
  };
  std::error_code error;
  if (!fs::is_directory(folder, error)) return {};
  if (is_protected(folder)) return folder;
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code unknown;
    if (!entry->is_symlink(unknown) && entry->is_directory(unknown) && is_protected(entry->path()))
      return entry->path();
  }
  return {};
}

}  // namespace aligngs
