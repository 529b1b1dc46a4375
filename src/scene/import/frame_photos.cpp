#include "scene/import/frame_photos.h"

#include <algorithm>
#include <set>
#include <utility>

#include "io/file_system_error.h"
#include "io/text_encoding.h"
#include "scene/import/capture_text.h"
#include "scene/photo_lookup.h"
#include "scene/photo_mask.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

/// Whether there is such a folder. Error{kBadInput} where it may not be read.
bool is_readable_folder(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) return false;
  require_readable_folder(folder, {});
  return true;
}

void leave_out_hidden(Capture& capture, const std::set<std::string>& names) {
  for (const std::string& name : names) capture.left_out.push_back({name, "a hidden file is no photo", "remove it"});
}

void note_missing_photos(Capture& capture, const std::vector<std::string>& poses, const std::set<std::string>& photos) {
  for (const std::string& pose : poses) {
    if (!photos.count(pose))
      capture.left_out.push_back({as_utf8(pose), PhotoLookup::kMissing, "add the photo or remove its pose"});
  }
}

/// Files that are not hidden, with subfolders, in natural order. `hidden` gets the paths of hidden ones, `left_out`
/// the subfolders that may not be read.
std::vector<FileBelow> list_files_below(const fs::path& folder, const std::vector<std::string>& extensions,
                                        std::set<std::string>& hidden, std::vector<LeftOut>& left_out) {
  if (!is_readable_folder(folder)) return {};
  std::vector<std::pair<std::string, FileBelow>> files;  // by the path below the folder
  std::error_code error;
  fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied, error);
  for (const fs::recursive_directory_iterator end; !error && entry != end; entry.increment(error)) {
    const fs::path& file = entry->path();
    const fs::path below = file.lexically_relative(folder);
    std::error_code unknown;
    if (entry->is_directory(unknown)) {
      if (is_hidden(file) || file.filename() == kMaskFolder)
        entry.disable_recursion_pending();
      else if (!entry->is_symlink(unknown))
        use_or_leave_out(below.generic_string(), left_out, [&] { require_readable_folder(file, {}); });
      continue;
    }
    if (!has_extension(file, extensions)) continue;
    if (is_hidden(file))
      hidden.insert(as_utf8(below.generic_string()));
    else
      files.emplace_back(below.generic_string(),
                         FileBelow{file, (below.parent_path() / below.stem()).generic_string()});
  }
  std::sort(files.begin(), files.end(), [](const auto& a, const auto& b) { return natural_less(a.first, b.first); });
  std::vector<FileBelow> sorted;
  for (auto& [path, file] : files) sorted.push_back(std::move(file));
  return sorted;
}

}  // namespace

std::vector<fs::path> list_frame_photos(Capture& capture, const fs::path& folder,
                                        const std::vector<std::string>& extensions) {
  if (!is_readable_folder(folder)) return {};
  std::error_code error;
  std::set<std::string> hidden;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (is_hidden(entry->path()) && has_picture_extension(entry->path()))
      hidden.insert(as_utf8(entry->path().filename().string()));
  }
  leave_out_hidden(capture, hidden);
  return list_files(folder, extensions);
}

void note_poses_without_photo(Capture& capture, const fs::path& poses, const std::vector<fs::path>& photos,
                              const char* ending) {
  std::set<std::string> names;
  for (const fs::path& photo : photos) names.insert(photo.stem().string());
  std::vector<std::string> stems;
  for (const fs::path& pose : list_files(poses, {ending})) stems.push_back(pose.stem().string());
  note_missing_photos(capture, stems, names);
}

std::vector<FileBelow> list_photos_below(Capture& capture, const fs::path& folder) {
  std::set<std::string> hidden;
  std::vector<FileBelow> photos = list_files_below(folder, picture_extensions(), hidden, capture.left_out);
  leave_out_hidden(capture, hidden);
  return photos;
}

void note_poses_without_photo(Capture& capture, const fs::path& poses, const std::vector<FileBelow>& photos) {
  std::set<std::string> names, hidden;
  for (const FileBelow& photo : photos) names.insert(photo.name);
  std::vector<std::string> stems;
  for (const FileBelow& pose : list_files_below(poses, {".txt"}, hidden, capture.left_out)) stems.push_back(pose.name);
  note_missing_photos(capture, stems, names);
}

}  // namespace aligngs
