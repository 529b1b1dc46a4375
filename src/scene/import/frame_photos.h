// The photos of a layout that has them in a folder, and poses without a photo. src/scene/import internal.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/picture_format.h"
#include "scene/import/capture.h"

namespace aligngs {

/// The photos of a folder in natural order; hidden ones are left out with a line. None where there is no such folder.
/// Error{kBadInput} where it may not be read.
std::vector<std::filesystem::path> list_frame_photos(Capture& capture, const std::filesystem::path& folder,
                                                     const std::vector<std::string>& extensions = picture_extensions());

/// Lists the poses of a folder (NAME.txt, or another ending) whose photo is missing.
void note_poses_without_photo(Capture& capture, const std::filesystem::path& poses,
                              const std::vector<std::filesystem::path>& photos, const char* ending = ".txt");

/// A file in a folder or in one of its subfolders.
struct FileBelow {
  std::filesystem::path file;
  std::string name;  ///< path below the folder without extension: "left/0001"
};

/// The same two with subfolders. Hidden folders and masks/ are not searched, and links to folders are not followed.
/// Subfolders that may not be read are left out with a line.
std::vector<FileBelow> list_photos_below(Capture& capture, const std::filesystem::path& folder);
void note_poses_without_photo(Capture& capture, const std::filesystem::path& poses,
                              const std::vector<FileBelow>& photos);

}  // namespace aligngs
