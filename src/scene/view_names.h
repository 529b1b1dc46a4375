// Names of images in camera files that may be paths on another machine or parts of web addresses.
#pragma once

#include <string>
#include <vector>

namespace aligngs {

/// Whether an image name does not stay below a folder of photos: it is absolute, begins with a drive of Windows ("C:")
/// or holds "..".
bool leads_elsewhere(const std::string& image_name);
/// A name with the bytes that a web address writes as "%20"; empty where it has none, or a "%" that begins no byte.
std::string percent_decoded(const std::string& name);
/// Absolute as a path of Linux or Windows.
bool is_absolute_name(const std::string& image_name);

/// The names without root, drive and "..", and without the folders that all of them share.
std::vector<std::string> without_shared_folders(const std::vector<std::string>& image_names);

}  // namespace aligngs
