// Allowed places of output: never into or over what a command reads.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace aligngs {

/// Absolute, with symbolic links and ".." resolved as far as the path exists, without a trailing slash.
std::filesystem::path real_place(const std::filesystem::path& path);

/// Whether `path` is `folder` or lies in it, by what the file system says: links, "..", folders that are mounted twice.
/// A path that is not there yet lies where its nearest parent that is there lies. `folder` may be a file, in which only
/// the file itself lies.
bool lies_within(const std::filesystem::path& path, const std::filesystem::path& folder);

/// Error{kUsage} when writing `output` would write into one of the sources or over it: it is one, lies in one, or holds
/// one. Empty paths among the sources are left out.
void require_apart(const std::filesystem::path& output, const std::vector<std::filesystem::path>& sources);

/// Error{kUsage} unless `file` is absent, a regular file or a link to one. Files appear by a rename, which would remove a
/// device, a pipe or a socket of that name (/dev/null). "-" and an empty name are no files either.
void require_file_place(const std::filesystem::path& file);

/// Error{kUsage} when the name of `file` promises another format than `format` ("glb", "labels.ply"), whatever its
/// case. A name that ends in a known extension must end in this one, and one that ends in ".labels.ply" is for
/// labels. A name without such an ending promises nothing.
void require_extension(const std::filesystem::path& file, const std::string& format);

/// Before long work: Error{kUsage} where `folder` is no name of a folder, or a file is in its way. Error{kResources}
/// where it is missing and cannot be made. A folder of another name is made beside it for that, and removed.
void require_folder_place(const std::filesystem::path& folder);

/// Why a folder with something in it is refused.
struct TakenFolder {
  std::string what;    ///< "the folder for the pictures is taken"
  std::string field;   ///< option that names it
  std::string remedy;  ///< "name a new or empty folder"
};

/// require_folder_place(), and Error{kUsage} where `folder` is a file or has something in it.
void require_empty_folder_place(const std::filesystem::path& folder, const TakenFolder& taken);

/// Before long work: require_file_place(). Error{kResources} too where the folder of `file` takes no new file, or is missing
/// and cannot be made.
void require_output_file(const std::filesystem::path& file);

}  // namespace aligngs
