// Pictures inside a page that needs no other file.
#pragma once

#include <filesystem>
#include <string>

namespace aligngs {

/// A page shows this many views, to stay at some megabytes; the rest are in renders/test.
inline constexpr int kMaxViewsOnPage = 12;

/// A table cell with the picture as JPEG, reduced so that several fit on a screen; an empty cell without such a file.
std::string picture_cell(const std::filesystem::path& file);

}  // namespace aligngs
