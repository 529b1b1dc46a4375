#include "edit/report_json.h"

#include <nlohmann/json.hpp>

namespace aligngs {

std::string object_name(const SelectedObject& object, const LabelSet& labels) {
  if (object.label < 0) return "without a class";
  const std::string& name = labels.classes.at(static_cast<size_t>(object.label)).name;
  return object.instance ? name + "#" + std::to_string(object.instance) : name + " (crumbs)";
}

nlohmann::json report_json(const EditReport& report, const LabelSet& labels) {
  nlohmann::json objects = nlohmann::json::array();
  for (const SelectedObject& object : report.objects) {
    objects.push_back({{"object", object_name(object, labels)},
                       {"class_id", object.label},
                       {"instance", object.instance},
                       {"gaussians", object.gaussians}});
  }
  nlohmann::json contents = nlohmann::json::array();
  for (const SelectedObject& object : report.contents) contents.push_back(object_name(object, labels));
  nlohmann::json parts = nlohmann::json::array();
  for (const SelectedObject& object : report.parts) parts.push_back(object_name(object, labels));
  return {{"edit", report.description},
          {"left_behind", contents},
          {"absent", report.absent},
          {"parts", parts},
          {"warnings", report.warnings},
          {"replacement",
           report.replacement ? nlohmann::json(object_name(*report.replacement, labels)) : nlohmann::json(nullptr)},
          {"inserted_gaussians", report.inserted},
          {"objects", objects},
          {"selected_gaussians", report.selected},
          {"gaussians_before", report.before},
          {"gaussians_after", report.after},
          {"filled_gaussians", report.filled},
          {"cleared_gaussians", report.cleared},
          {"selected_vertices", report.selected_vertices},
          {"vertices_before", report.vertices_before},
          {"vertices_after", report.vertices_after},
          {"threshold", report.threshold > 0 ? nlohmann::json(report.threshold) : nlohmann::json(nullptr)}};
}

nlohmann::json selections_json(const RoomSelections& selections) {
  nlohmann::json list = nlohmann::json::array();
  for (const NamedSelection& s : selections.list)
    list.push_back({{"name", s.name}, {"gaussians", s.count()}, {"usable", selections.is_usable(s)}});
  return list;
}

}  // namespace aligngs
