#include "io/file_system_error.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

namespace aligngs {

namespace fs = std::filesystem;

const char* remedy_for_write(int code) {
  switch (code) {
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
      return "free disk space or write elsewhere";
    case ENAMETOOLONG:
      return "use a shorter name";
    case EACCES:
    case EPERM:
    case EROFS:
      return "choose a folder you may write to";
    default:
      return "check the folder and the disk";
  }
}

std::string cannot_open(int code) {
  return code == 0 ? std::string("cannot open") : std::string("cannot open: ") + std::strerror(code);
}

namespace {

constexpr uintmax_t kFull = 64 * 1024;  // bytes: less than programs write at once

/// The outermost folder on the way that may not be entered or read; the path itself where all may.
fs::path barred_folder(const fs::path& path) {
  std::error_code error;
  fs::path at;
  for (const fs::path& part : fs::absolute(path, error)) {
    at /= part;
    if (fs::is_directory(at, error) && ::faccessat(AT_FDCWD, at.c_str(), R_OK | X_OK, AT_EACCESS) != 0) return at;
  }
  return path;
}

bool is_full(const fs::path& place) {
  std::error_code unknown;
  const fs::space_info space = fs::space(nearest_existing(fs::absolute(place, unknown)), unknown);
  return !unknown && space.available < kFull;
}

}  // namespace

fs::path nearest_existing(fs::path path) {
  std::error_code unknown;
  while (!fs::exists(path, unknown) && path != path.parent_path()) path = path.parent_path();
  return path;
}

std::error_code cause_of_write(const std::error_code& error, const fs::path& place) {
  const bool vague = error == std::errc::io_error || error == std::errc::no_such_device;
  return vague && is_full(place) ? std::make_error_code(std::errc::no_space_on_device) : error;
}

Error error_of(const std::filesystem::filesystem_error& error) {
  const auto bad_path = [&](const char* message, const char* remedy) {
    return Error({ErrorKind::kBadInput, message, error.path1(), {}, remedy});
  };
  switch (error.code().value()) {
    case ELOOP:
      return bad_path("this link leads to itself", "replace the link, or remove it");
    case ENOTDIR:
      return bad_path("a file stands where a folder should be", "check the path");
    case ENAMETOOLONG:
      return bad_path("the name is too long", "use a shorter name");
    case EACCES:
      return Error({ErrorKind::kBadInput,
                    "this place may not be read: Permission denied",
                    barred_folder(error.path1()),
                    {},
                    "change its permissions"});
    default:
      return Error(
          {ErrorKind::kResources, error.code().message(), error.path1(), {}, remedy_for_write(error.code().value())});
  }
}

void require_readable_folder(const fs::path& folder, const std::string& remedy) {
  std::error_code error;
  const fs::file_status status = fs::status(folder, error);
  if (status.type() == fs::file_type::not_found) throw_bad_input(folder, "", "there is no such folder", remedy);
  if (error) throw error_of(fs::filesystem_error("status", folder, error));
  if (!fs::is_directory(status)) throw_bad_input(folder, "", "this is neither a folder nor a video", remedy);
  const fs::directory_iterator entries(folder, error);
  if (!error && ::faccessat(AT_FDCWD, folder.c_str(), X_OK, AT_EACCESS) != 0)
    error = std::make_error_code(std::errc::permission_denied);
  if (error) throw error_of(fs::filesystem_error("list", folder, error));
}

void make_folders(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    throw_resources(folder, "the folder cannot be created: " + error.message(), remedy_for_write(error.value()));
}

void refuse_full_disk(const std::filesystem::path& folder) {
  if (is_full(folder))
    throw_resources(folder, std::string("cannot write: ") + std::strerror(ENOSPC), remedy_for_write(ENOSPC));
}

}  // namespace aligngs
