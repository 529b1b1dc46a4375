// One picture of a run: a few test views, each as photo, render, depth, normals and labels, under titles.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace aligngs {

/// Subfolders of renders/<split>/, in the order in which people compare them.
inline constexpr const char* kRenderKinds[] = {"gt", "rgb", "error", "depth", "normal", "surface", "label"};

/// Names (without extension) of the views under renders/<split>/rgb, in order.
std::vector<std::string> rendered_views(const std::filesystem::path& run, const std::string& split);

/// Writes overview.jpg; does nothing when there are no renders.
void write_overview(const std::filesystem::path& run);

}  // namespace aligngs
