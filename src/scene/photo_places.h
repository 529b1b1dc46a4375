// Places of a data set's photos: folders of other names than expected, and what is around a folder that was given.
#pragma once

#include <filesystem>
#include <string>

namespace aligngs {

/// The folder of a data set's photos: images/, else the one of images_2/, images_4/, ... that holds the largest, else
/// ScanNet++'s resized_images/. Empty where there is none.
std::filesystem::path images_folder(const std::filesystem::path& folder);

/// Whether a folder beside a COLMAP model has ScanNet++'s undistorted photos, which have other cameras, or masks.
bool fits_other_cameras(const std::filesystem::path& photos);

/// The data set that `folder` is the model of, as "room" for "room/sparse/0": the nearest of the two folders above that
/// has an images_folder(). Empty where there is none.
std::filesystem::path data_set_around(const std::filesystem::path& folder);

/// The remedy for photos that are not in the data set `folder`.
std::string missing_photos_remedy(const std::filesystem::path& folder);

}  // namespace aligngs
