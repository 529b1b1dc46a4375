// A folder of photos as people have them, made ready for whatever finds their cameras.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/thread_pool.h"
#include "io/left_out.h"

namespace aligngs {

struct Photo {
  std::string name;  ///< what the view will be called: its path below the folder, without extension, in UTF-8
  std::filesystem::path file;
  int width = 0, height = 0;  ///< pixels, upright
};

struct PhotoList {
  std::filesystem::path folder;  ///< that holds the photos: the given one or its images/
  std::vector<Photo> photos;
  std::vector<LeftOut> left_out;  ///< hidden, empty, cut and unreadable files, and second ones of a name
  std::string unread;             ///< names of pictures whose formats are not read, a blank before each
};

/// Pictures (io/picture_format.h) of the folder, in natural order (2 before 10). If it holds none, those of its
/// images/, else of all its subfolders but masks/. Error{kBadInput}: fewer than two photos that can be used. Pictures
/// in formats that are not read (TIFF, raw, ...) are named in the error or in `unread`.
PhotoList list_photos(const std::filesystem::path& folder);
/// The same for photos that cameras name: hidden files may be among them, so that fewer are no error.
PhotoList list_named_photos(const std::filesystem::path& folder);

/// Whether list_photos would find any.
bool has_photos(const std::filesystem::path& folder);

/// Copies into `folder` under <name>.jpg or .png. Unchanged if upright and no side exceeds `max_side` pixels. Else
/// turned and resized (JPEG of quality 95, with the focal length that the camera wrote into it). The result lists the
/// copies. Masks (scene/photo_mask.h) go to masks/ beside `folder`, a white one for a photo without. No photo with a
/// mask: none is written. `left_out` gets photos whose pixels or masks are damaged.
std::vector<Photo> prepare_photos(const std::vector<Photo>& photos, const std::filesystem::path& folder, int max_side,
                                  ThreadPool& pool, std::vector<LeftOut>& left_out);

}  // namespace aligngs
