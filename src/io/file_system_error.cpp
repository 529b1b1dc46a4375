#include "io/file_system_error.h"

#include <cerrno>
#include <cstring>
#include <string>

namespace aligngs {

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
      return bad_path("this place may not be read: Permission denied", "change its permissions");
    default:
      return Error(
          {ErrorKind::kResources, error.code().message(), error.path1(), {}, remedy_for_write(error.code().value())});
  }
}

void make_folders(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    throw_resources(folder, "the folder cannot be created: " + error.message(), remedy_for_write(error.value()));
}

void refuse_full_disk(const std::filesystem::path& folder) {
  constexpr uintmax_t kFull = 64 * 1024;  // bytes: less than such a program writes at once
  std::error_code unknown;
  const std::filesystem::space_info space = std::filesystem::space(folder, unknown);
  if (!unknown && space.available < kFull)
    throw_resources(folder, std::string("cannot write: ") + std::strerror(ENOSPC), remedy_for_write(ENOSPC));
}

}  // namespace aligngs
