// Results of edits and selections, for programs: `aligngs edit --json` and the page show the same.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "edit/apply_edit.h"

namespace aligngs {

/// "pillow#2", "pillow (crumbs)", "without a class".
std::string object_name(const SelectedObject& object, const LabelSet& labels);

/// {"edit", "objects": [{"object", "class_id", "instance", "gaussians"}], "selected_gaussians", "gaussians_before",
/// "gaussians_after", "filled_gaussians", "selected_vertices", "vertices_before", "vertices_after", "threshold"}
nlohmann::json report_json(const EditReport& report, const LabelSet& labels);

/// Selections that were drawn by hand: [{"name", "gaussians", "usable"}]
nlohmann::json selections_json(const RoomSelections& selections);

}  // namespace aligngs
