// Files that the user names for output never replace somebody's data.
#pragma once

#include <filesystem>
#include <string_view>

namespace aligngs {

/// Error{kUsage} where a file of this name would be one of these, whether it is there already or not:
///   a file of a run or of a scene, of this or another run;
///   a file in a folder for photos, cameras or depth of a data set that `import` knows.
/// Error{kUsage}, too, where it is there already and is one of these:
///   a picture or video that this program has not drawn (io/drawn_picture.h), such as a photo;
///   a page of HTML that this program has not written;
///   a file in another subfolder of such a data set, or one of its descriptions or points.
/// `own_beginning`: how the program's files of this kind begin, where all of them begin alike. A file that begins so may
/// be replaced, also in a data set, and any other file may not. Empty: nothing is known of it.
void require_replaceable(const std::filesystem::path& file, std::string_view own_beginning = {});

}  // namespace aligngs
