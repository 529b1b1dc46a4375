#include "core/standard_streams.h"

#include <fcntl.h>
#include <unistd.h>

#include <initializer_list>

namespace aligngs {

void reserve_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) >= 0) continue;
    // A new descriptor has the lowest free number. Open for reading alone, it keeps writes an error.
    if (open("/dev/null", O_RDONLY) != stream) return;  // without /dev/null everything stays as it was
  }
}

}  // namespace aligngs
