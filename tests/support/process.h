// Starts the program under test as a user would and keeps what it said.
#pragma once

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace aligngs::testing_support {

struct ProcessResult {
  int status = -1;  ///< exit status; 128 + signal when a signal ended it
  std::string out, err;
};

/// Runs `aligngs <arguments>` through the shell; `arguments` is shell text.
inline ProcessResult run_aligngs(const std::string& arguments, const std::filesystem::path& scratch) {
  std::filesystem::create_directories(scratch);
  const std::filesystem::path err_file = scratch / "stderr.txt";
  const std::string command = std::string("'") + ALIGNGS_PROGRAM + "' " + arguments + " 2>'" + err_file.string() + "'";
  ProcessResult result;
  FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) return result;
  std::array<char, 4096> buffer;
  for (size_t n; (n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) result.out.append(buffer.data(), n);
  const int status = pclose(pipe);
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  std::ostringstream text;
  text << std::ifstream(err_file).rdbuf();
  result.err = text.str();
  return result;
}

}  // namespace aligngs::testing_support
