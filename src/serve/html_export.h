// One HTML file that shows a room without a server: the page of `aligngs view` with the splats inside.
#pragma once

#include <filesystem>
#include <string>

#include "edit/apply_edit.h"

namespace aligngs {

struct HtmlSceneInfo {
  std::string name;               ///< shown as the title
  bool metric = false;            ///< the scene's units are metres
  std::filesystem::path cameras;  ///< cameras.json of the run; left out when it cannot be read
};

/// Exact positions, classes and objects. Colours, opacities, scales and rotations are rounded below visible
/// differences. Values are stored column by column, so that they compress to about a tenth of scene.ply. Gaussians that
/// nobody can see (opacity below 1/255) are left out.
void write_html(const std::filesystem::path& path, const EditableRoom& room, const HtmlSceneInfo& info);

/// The data in the file: a JSON line {"state", "count", "columns": [{"name", "type", "step"}]}, then each column's
/// numbers, little-endian. A value is its number x step; "label", "instance" and "confidence" have step 1.
std::string packed_scene(const EditableRoom& room, const HtmlSceneInfo& info);

}  // namespace aligngs
