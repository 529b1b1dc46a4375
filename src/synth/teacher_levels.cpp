#include "synth/teacher_levels.h"

#include <cmath>

#include "core/error.h"

namespace aligngs {

const char* teacher_level_name(TeacherLevel level) {
  switch (level) {
    case TeacherLevel::kLow:
      return "low";
    case TeacherLevel::kMedium:
      return "medium";
    case TeacherLevel::kHigh:
      return "high";
    case TeacherLevel::kBase:
      return "base";
    case TeacherLevel::kSmall:
      return "small";
  }
  return "";
}

TeacherLevel parse_teacher_level(const std::string& name) {
  for (const TeacherLevel level : kTeacherLevels) {
    if (name == teacher_level_name(level)) return level;
  }
  throw_usage("there is no level of errors called " + name, "use low, medium, high, base or small");
}

std::vector<std::string> teacher_level_names() {
  std::vector<std::string> names;
  for (const TeacherLevel level : kTeacherLevels) names.emplace_back(teacher_level_name(level));
  return names;
}

std::optional<PublishedGeometry> published_geometry(TeacherLevel level) {
  if (level == TeacherLevel::kMedium) return PublishedGeometry{"VGGT-1B", 0.700, 0.105};
  if (level == TeacherLevel::kBase) return PublishedGeometry{"DA3-Base", 0.566, 0.159};
  if (level == TeacherLevel::kSmall) return PublishedGeometry{"DA3-Small", 0.476, 0.191};
  return std::nullopt;
}

namespace {

/// The medium level with larger errors. The published means cover outdoor scenes and failures, so a room cannot have
/// their values. Their ratios to VGGT's are kept: of 1 - AUC for cameras, of AbsRel for depth.
GeometryTeacherSettings weaker_than_medium(TeacherLevel level) {
  const PublishedGeometry medium = *published_geometry(TeacherLevel::kMedium), weaker = *published_geometry(level);
  const double cameras = (1 - weaker.auc_30) / (1 - medium.auc_30), depth = weaker.abs_rel / medium.abs_rel;
  GeometryTeacherSettings s = geometry_teacher_settings(TeacherLevel::kMedium);
  for (double* camera_error : {&s.bend_rms, &s.bend_degrees, &s.rotation_degrees, &s.translation, &s.outlier_share,
                               &s.shared_focal, &s.view_focal}) {
    *camera_error *= cameras;
  }
  for (double* depth_error : {&s.view_scale, &s.warp_rms, &s.failure_share, &s.shared_failure_size}) {
    *depth_error *= depth;
  }
  s.edge_width *= std::sqrt(depth);  // an edge's blur grows with the coarseness of the features, not with their error
  return s;
}

}  // namespace

GeometryTeacherSettings geometry_teacher_settings(TeacherLevel level) {
  if (level == TeacherLevel::kBase || level == TeacherLevel::kSmall) return weaker_than_medium(level);
  GeometryTeacherSettings s;
  const int i = static_cast<int>(level);
  const auto pick = [i](double low, double medium, double high) { return i == 0 ? low : (i == 1 ? medium : high); };
  s.bend_rms = pick(0.006, 0.014, 0.028);
  s.bend_degrees = pick(0.8, 2.2, 4.5);
  s.failure_share = pick(0, 0.01, 0.06);
  s.shared_failure_share = pick(0.12, 0.26, 0.4);
  s.rotation_degrees = pick(0.1, 0.25, 0.6);
  s.translation = pick(0.003, 0.008, 0.02);
  s.outlier_share = pick(0, 0.03, 0.08);
  s.shared_focal = pick(0.005, 0.015, 0.03);
  s.view_focal = pick(0.003, 0.007, 0.015);
  s.view_scale = s.warp_rms = pick(0.004, 0.008, 0.015);
  s.edge_width = pick(1.5, 2.5, 4);
  return s;
}

}  // namespace aligngs
