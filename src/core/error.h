// The one error type of the project. A failure whose reason lies outside the program is thrown as
// an Error. src/cli maps its kind to the exit status in one place.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace aligngs {

/// Why something failed. The numeric value is the exit status of the program (design, section 5).
enum class ErrorKind : int {
  kFailed = 1,       ///< the operation itself failed (diverged, external program failed)
  kUsage = 2,        ///< a wrong command line or configuration
  kBadInput = 3,     ///< a file or folder that is not what it should be
  kWeights = 4,      ///< network weights missing or corrupt
  kResources = 5,    ///< memory, disk or device
  kBelow = 6,        ///< --fail-under not met
  kInterrupted = 75  ///< stopped by a signal with a checkpoint written
};

/// An error that says what is wrong, where (file and field) and what to do about it.
class Error : public std::runtime_error {
 public:
  struct Details {
    ErrorKind kind = ErrorKind::kFailed;
    std::string message;         ///< what is wrong, one sentence without a final stop
    std::filesystem::path path;  ///< the file or folder concerned; may be empty
    std::string field;           ///< the field, line or property in it; may be empty
    std::string remedy;          ///< what the user can do; may be empty
  };

  explicit Error(Details details);

  ErrorKind kind() const { return details_.kind; }
  const Details& details() const { return details_; }
  int exit_status() const { return static_cast<int>(details_.kind); }

 private:
  Details details_;
};

/// Shorthand for the commonest case: a file that is not what it should be (exit status 3).
[[noreturn]] void throw_bad_input(const std::filesystem::path& path, const std::string& field,
                                  const std::string& message, const std::string& remedy = {});
[[noreturn]] void throw_usage(const std::string& message, const std::string& remedy = {});
[[noreturn]] void throw_resources(const std::filesystem::path& path, const std::string& message,
                                  const std::string& remedy = {});

}  // namespace aligngs
