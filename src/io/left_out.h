// One bad frame is left out with a line; the others go on. The same rule for every reader, for training and for
// `--strict`.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "core/error.h"
#include "io/file_system_error.h"

namespace aligngs {

/// A frame, photo or view that is not used, and why.
struct LeftOut {
  std::string name;
  std::string reason;
  std::string remedy;  ///< may be empty
};

/// Reason and remedy of an error that concerns one frame: its file, field and message.
LeftOut left_out_for(const std::string& name, const Error& error);

/// "54 of 56 frames; left out: a (the photo is missing), b (...)": at most ten are named.
std::string summary_of(size_t kept, const std::vector<LeftOut>& left_out, const char* what = "frames");

/// A warning for each, and the summary after them. Nothing when none is left out.
void warn_left_out(size_t kept, const std::vector<LeftOut>& left_out, const char* what = "frames");

/// Error{kBadInput} with the summary when fewer than `fewest` are kept and some were left out, or when `strict` is set
/// and one was left out. The remedy is that of the first.
void require_enough(const std::filesystem::path& folder, size_t kept, const std::vector<LeftOut>& left_out,
                    size_t fewest, bool strict, const char* what = "frames");

/// Runs `use`; an Error{kBadInput} of it, or a path that cannot be followed, leaves the frame out. Any other error goes on
/// upwards.
template <class Use>
bool use_or_leave_out(const std::string& name, std::vector<LeftOut>& left_out, Use use) {
  try {
    use();
    return true;
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kBadInput) throw;
    left_out.push_back(left_out_for(name, error));
  } catch (const std::filesystem::filesystem_error& failed) {
    const Error error = error_of(failed);
    if (error.kind() != ErrorKind::kBadInput) throw;
    left_out.push_back(left_out_for(name, error));
  }
  return false;
}

}  // namespace aligngs
