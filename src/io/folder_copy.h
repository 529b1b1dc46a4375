// Copies of folders that belong to whoever made them.
#pragma once

#include <filesystem>
#include <system_error>

namespace aligngs {

enum class CopiedLinks {
  kFollowed,  ///< what a link leads to is copied
  kKept       ///< the link itself is copied
};

/// Copies a file, or a folder with all in it. `to` may be a folder already; its files must be new. Protection against
/// writing is not copied: a scene on read-only storage becomes one that can be changed. Stops at the first error.
void copy_folder(const std::filesystem::path& from, const std::filesystem::path& to, CopiedLinks links,
                 std::error_code& error);

/// The same with one file in two places instead of copies (hard links), which only one file system can do.
void link_folder(const std::filesystem::path& from, const std::filesystem::path& to, std::error_code& error);

/// The first folder in `folder`, or itself, that may not be changed, so that what lies in it can be neither replaced nor
/// removed. Empty: none, or there is no such folder.
std::filesystem::path first_protected_folder(const std::filesystem::path& folder);

}  // namespace aligngs
