#include "serve/file_version.h"

#include <fmt/format.h>

#include <system_error>

namespace aligngs {

std::string file_version(const std::filesystem::path& path) {
  std::error_code error;
  const auto time = std::filesystem::last_write_time(path, error);
  if (error) return "";
  const auto size = std::filesystem::file_size(path, error);
  return error ? "" : fmt::format("{:x}-{:x}", static_cast<uint64_t>(time.time_since_epoch().count()), size);
}

}  // namespace aligngs
