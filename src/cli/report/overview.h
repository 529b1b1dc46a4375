// One picture of a run: a few views, each as photo, render, depth, normals and labels, under titles.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace aligngs {

/// A subfolder of renders/<split>/.
struct RenderKind {
  const char* folder;
  const char* title;
  bool in_overview;
};
/// In the order in which people compare them.
inline constexpr RenderKind kRenderKinds[] = {
    {"gt", "photo", true},       {"rgb", "render", true},    {"error", "error", false}, {"depth", "depth", true},
    {"normal", "normals", true}, {"surface", "mesh", false}, {"label", "labels", true}};

/// Names (without extension) of the views under renders/<split>/rgb, in order.
std::vector<std::string> rendered_views(const std::filesystem::path& run, const std::string& split);

/// Renders that show a run: of its test views, or of training views where there are none of those.
struct ShownRenders {
  std::string split;               ///< "test" or "train"
  std::vector<std::string> views;  ///< empty: the run has no renders
  std::filesystem::path folder(const std::filesystem::path& run) const { return run / "renders" / split; }
};
ShownRenders shown_renders(const std::filesystem::path& run);

/// Writes overview.jpg; does nothing when there are no renders.
void write_overview(const std::filesystem::path& run);

}  // namespace aligngs
