// Findings of COLMAP in photos and pairs of photos, read from its database (an SQLite file).
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace aligngs {

struct ColmapDatabase {
  struct Photo {
    uint32_t id = 0;
    std::string name;
    int64_t features = 0;
  };
  struct Pair {
    uint32_t first = 0, second = 0;  ///< ids of photos
    int64_t matches = 0;             ///< of descriptors
    int64_t verified = 0;            ///< that agree with one relative pose
  };
  std::vector<Photo> photos;  ///< by id
  std::vector<Pair> pairs;    ///< by ids
};

/// Reads the numbers alone, not the features. Error{kBadInput} when it is no such file or damaged.
ColmapDatabase read_colmap_database(const std::filesystem::path& path);
ColmapDatabase decode_colmap_database(std::string_view bytes, const std::filesystem::path& name_for_errors);

}  // namespace aligngs
