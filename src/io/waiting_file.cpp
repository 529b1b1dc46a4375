#include "io/waiting_file.h"

#include <string>
#include <system_error>

#include "core/error.h"

namespace aligngs {

namespace fs = std::filesystem;

void require_no_waiting(const fs::path& file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (!fs::is_fifo(status) && !fs::is_socket(status) && !fs::is_character_file(status) && !fs::is_block_file(status))
    return;
  const std::string name = file.string();
  for (const char* passed : {"/dev/fd/", "/dev/stdin", "/dev/null", "/proc/"}) {
    if (name.rfind(passed, 0) == 0) return;
  }
  throw_bad_input(file, "", "this is a pipe or a device, not a file", "copy what it gives to a file");
}

}  // namespace aligngs
