// Other programs, as tests ask them.
#pragma once

#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace aligngs::testing_support {

/// Whether a command of the shell ends with status 0. Its output is discarded.
inline bool runs(const std::string& command) { return std::system((command + " >/dev/null 2>&1").c_str()) == 0; }

/// Standard output of a command of the shell; empty where it cannot be started.
inline std::string output_of(const std::string& command) {
  std::string out;
  FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) return out;
  std::array<char, 4096> buffer;
  for (size_t n; (n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) out.append(buffer.data(), n);
  pclose(pipe);
  return out;
}

}  // namespace aligngs::testing_support
