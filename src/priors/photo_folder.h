// A folder of photos as people have them, made ready for whatever finds their cameras.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/thread_pool.h"

namespace aligngs {

struct Photo {
  std::string name;            ///< stem of the file: what the view will be called
  std::filesystem::path file;
  int width = 0, height = 0;   ///< pixels, upright
};

/// JPEG and PNG files of the folder (or, when it holds none, of its images/), in the order of
/// people (2 before 10). Error{kBadInput}: fewer than two photos, two of one stem, files that are no
/// pictures. Pictures in formats that are not read (HEIC, ...) are named in the error or a warning.
std::vector<Photo> list_photos(const std::filesystem::path& folder);

/// Whether list_photos would find any.
bool has_photos(const std::filesystem::path& folder);

/// Copies into `folder` under <name>.jpg or .png: as they are where they are upright and neither
/// side exceeds `max_side` pixels, else turned and resized (JPEG of quality 95, with the focal length
/// that the camera wrote into it). The result lists the copies.
std::vector<Photo> prepare_photos(const std::vector<Photo>& photos,
                                  const std::filesystem::path& folder, int max_side,
                                  ThreadPool& pool);

}  // namespace aligngs
