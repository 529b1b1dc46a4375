#include "scene/unused_masks.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "core/letter_case.h"
#include "io/picture_format.h"
#include "io/text_encoding.h"
#include "scene/photo_lookup.h"
#include "scene/photo_mask.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

fs::path plain_path(const fs::path& path) {
  fs::path plain = fs::absolute(path).lexically_normal();
  return plain.has_filename() ? plain : plain.parent_path();
}

bool is_below(const fs::path& path, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

/// Pictures in the order of their paths. The files of a subfolder count as well where that is wanted.
std::vector<fs::path> pictures_in(const fs::path& folder, bool deep) {
  std::vector<fs::path> pictures;
  std::error_code error;
  fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied, error);
  for (const fs::recursive_directory_iterator end; !error && entry != end; entry.increment(error)) {
    std::error_code unknown;
    if (!deep && entry->is_directory(unknown)) entry.disable_recursion_pending();
    if (!is_hidden(entry->path()) && has_picture_extension(entry->path()) && entry->is_regular_file(unknown))
      pictures.push_back(entry->path());
  }
  std::sort(pictures.begin(), pictures.end());
  return pictures;
}

/// Folders in which find_mask() looks for masks/, as far as they belong to `folder`.
std::set<fs::path> folders_around(const fs::path& folder, const std::vector<fs::path>& photos) {
  constexpr int kFoldersAround = 3;
  fs::path root = plain_path(folder);
  if (root.filename() == "images") root = root.parent_path();
  std::set<fs::path> folders;
  for (const fs::path& photo : photos) {
    fs::path around = plain_path(photo).parent_path();
    for (int i = 0; i < kFoldersAround && is_below(around, root); ++i, around = around.parent_path())
      folders.insert(around);
  }
  return folders;
}

/// The given photos and those beside them: one without a camera may have its mask as well.
std::set<fs::path> masks_of(const std::vector<fs::path>& photos) {
  std::set<fs::path> folders, masks;
  const auto add = [&](const fs::path& photo) {
    if (const fs::path mask = find_mask(photo); !mask.empty()) masks.insert(plain_path(mask));
  };
  for (const fs::path& photo : photos) {
    add(photo);
    folders.insert(plain_path(photo).parent_path());
  }
  for (const fs::path& folder : folders) {
    for (const fs::path& photo : pictures_in(folder, false)) add(photo);
  }
  return masks;
}

/// Tells where find_mask() looks in this folder for the mask of a photo, with one of the photos.
std::string name_of_a_mask(const fs::path& around, const std::vector<fs::path>& photos) {
  fs::path photo = "images/a.jpg";
  for (const fs::path& candidate : photos) {
    if (!is_below(plain_path(candidate), around)) continue;
    photo = plain_path(candidate).lexically_relative(around);
    break;
  }
  fs::path from_there = photo;
  if (photo.has_parent_path()) from_there = photo.lexically_relative(*photo.begin());
  const std::string whole = as_utf8((kMaskFolder / from_there).generic_string());
  const std::string bare = as_utf8((kMaskFolder / from_there.parent_path() / from_there.stem()).generic_string());
  return fmt::format("name a mask as its photo: {} has {}.png or {}.png", as_utf8(photo.generic_string()), whole, bare);
}

}  // namespace

std::vector<SceneProblem> unused_masks(const fs::path& folder, const std::vector<fs::path>& photos,
                                       const std::vector<fs::path>& named) {
  std::vector<SceneProblem> problems;
  std::set<fs::path> used;
  bool found = false;  // whose masks they are is asked where there are some
  for (const fs::path& around : folders_around(folder, photos)) {
    std::error_code error;
    for (fs::directory_iterator entry(around, error), end; !error && entry != end; entry.increment(error)) {
      const std::string name = entry->path().filename().string(), word = lower_case(name);
      std::error_code unknown;
      if ((word != kMaskFolder && word != "mask") || !entry->is_directory(unknown)) continue;
      std::vector<fs::path> masks = pictures_in(entry->path(), true);
      if (!std::exchange(found, true)) {
        used = masks_of(photos);
        for (const fs::path& mask : named) used.insert(plain_path(mask));
      }
      const size_t all = masks.size();
      std::erase_if(masks, [&](const fs::path& mask) { return used.count(plain_path(mask)) > 0; });
      if (masks.empty()) continue;
      const std::string example = as_utf8(masks.front().lexically_relative(entry->path()).string());
      const bool misnamed = name != kMaskFolder && masks.size() == all;
      problems.push_back(
          {entry->path(), kMaskFolder,
           misnamed ? fmt::format("{} {} in {}/ not used: the folder is not called {}/", all,
                                  all == 1 ? "picture is" : "pictures are", as_utf8(name), kMaskFolder)
           : masks.size() == 1
               ? fmt::format("a mask in {}/ fits no photo: {}", kMaskFolder, example)
               : fmt::format("{} masks in {}/ fit no photo, e.g. {}", masks.size(), kMaskFolder, example),
           misnamed ? fmt::format("rename the folder to {}/", kMaskFolder) : name_of_a_mask(around, photos), false});
    }
  }
  return problems;
}

std::string text_of_unused_masks(const SceneProblem& problem) {
  return fmt::format("{}\n  remedy: {}", problem.message, problem.remedy);
}

}  // namespace aligngs
