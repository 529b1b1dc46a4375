// Another program run as a child, its output read line by line.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace aligngs {

struct ChildResult {
  int status = -1;         ///< exit status; 128 + signal when a signal ended it
  std::string last_lines;  ///< of its output, at most about 2000 characters
};

/// Starts arguments[0], looked up in PATH; standard output and error go to `log` (appended) and,
/// line by line, to `on_line` (may be null). Error{kFailed} when it cannot be started;
/// Error{kInterrupted} when a signal asks this program to stop: the child is ended too.
ChildResult run_child(const std::vector<std::string>& arguments, const std::filesystem::path& log,
                      const std::function<void(const std::string&)>& on_line = nullptr);

/// Path of an executable of that name, by PATH; empty when it has none.
std::filesystem::path find_program(const std::string& name);

}  // namespace aligngs
