// metrics.json back into RunMetrics.
#include <cstdlib>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>
#include <type_traits>
#include <utility>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/json_text.h"
#include "metrics/metric_names.h"
#include "metrics/metrics_json.h"

namespace aligngs {
namespace {

using Json = nlohmann::json;

constexpr std::string_view kCullingMark = ", ", kAlignmentMark = ", alignment: ";  // of protocol_text

/// The member of an object; null where there is none.
const Json& member(const Json& json, const std::string& name) {
  static const Json none;
  if (!json.is_object()) return none;
  const auto found = json.find(name);
  return found == json.end() ? none : *found;
}

std::string text_member(const Json& json, const std::string& name) {
  const Json& node = member(json, name);
  return node.is_string() ? node.get<std::string>() : std::string();
}

void read_number(const Json& node, double& value) { value = node.is_number() ? node.get<double>() : kUndefined; }
void read_number(const Json& node, std::optional<uint64_t>& value) {
  constexpr double kLargestCount = 9007199254740992.0;  // 2^53: up to there doubles have every integer
  const double number = node.is_number() ? node.get<double>() : -1;
  value = number >= 0 && number <= kLargestCount ? std::optional(static_cast<uint64_t>(number)) : std::nullopt;
}
/// A count; 0 where there is none.
template <class Integer>
requires std::is_integral_v<Integer>
void read_number(const Json& node, Integer& value) {
  std::optional<uint64_t> count;
  read_number(node, count);
  value = count && *count <= static_cast<uint64_t>(std::numeric_limits<Integer>::max()) ? static_cast<Integer>(*count)
                                                                                        : Integer(0);
}

/// Gives the numbers of a part.
auto from(const Json& json) {
  return [&json](const std::string& name, auto& value) { read_number(member(json, name), value); };
}

/// The classes that some object {"wall": 0.9} of the file names.
void collect_classes(const Json& json, std::set<std::string>& names) {
  for (const char* by_class : {"iou", "class_coverage"}) {
    const Json& values = member(json, by_class);
    if (!values.is_object()) continue;
    for (const auto& [name, value] : values.items()) names.insert(name);
  }
  for (const char* part : {"present", "teacher", "mesh"}) {
    if (member(json, part).is_object()) collect_classes(member(json, part), names);
  }
}

std::vector<double> values_by_class(const Json& json, const LabelSet& labels) {
  std::vector<double> values(static_cast<size_t>(labels.size()), kUndefined);
  for (size_t c = 0; c < values.size(); ++c) read_number(member(json, labels.classes[c].name), values[c]);
  return values;
}

SemanticScores read_semantic_scores(const Json& json, const LabelSet& labels) {
  SemanticScores scores;
  each_semantic_number(scores, from(json));
  each_present_number(scores, from(member(json, "present")));
  scores.iou = values_by_class(member(json, "iou"), labels);
  scores.present_iou = values_by_class(member(member(json, "present"), "iou"), labels);
  return scores;
}

MeshLabelScores read_mesh_labels(const Json& json, const LabelSet& labels) {
  MeshLabelScores scores;
  scores.all = read_semantic_scores(json, labels);
  each_mesh_label_number(scores, from(json));
  scores.class_coverage = values_by_class(member(json, "class_coverage"), labels);
  return scores;
}

void read_semantics(const Json& json, RunMetrics& metrics) {
  std::set<std::string> names;
  collect_classes(json, names);
  for (const std::string& name : names) metrics.labels.classes.push_back({name, {}, {}});
  // The labels of a mesh alone are in an object without counts.
  if (member(json, "miou").is_number() || member(json, "samples").is_number())
    metrics.semantics = read_semantic_scores(json, metrics.labels);
  if (member(json, "teacher").is_object())
    metrics.teacher = read_semantic_scores(member(json, "teacher"), metrics.labels);
  if (member(json, "mesh").is_object()) metrics.mesh_labels = read_mesh_labels(member(json, "mesh"), metrics.labels);
}

std::optional<PoseError> read_pose_error(const Json& json) {
  if (!json.is_object()) return std::nullopt;
  PoseError error;
  each_pose_error_number(error, from(json));
  return error;
}

TestViewMetrics read_view(const Json& json) {
  TestViewMetrics view;
  view.name = text_member(json, "name");
  each_view_number(view, from(json));
  const Json& extrapolates = member(json, "extrapolates");
  view.extrapolates = extrapolates.is_boolean() && extrapolates.get<bool>();
  const Json& fit = member(json, "pose_refined");
  if (!fit.is_object()) return view;
  RefinedPoseMetrics refined;
  each_refined_pose_number(refined, from(fit));
  refined.before = read_pose_error(member(fit, "error_before"));
  refined.after = read_pose_error(member(fit, "error_after"));
  view.pose_refined = refined;
  return view;
}

std::optional<ViewGroupMetrics> read_group(const Json& json) {
  if (!json.is_object()) return std::nullopt;
  ViewGroupMetrics group;
  each_view_group_number(group, from(json));
  return group;
}

std::optional<NovelViewMetrics> read_novel_views(const Json& json) {
  if (!json.is_object()) return std::nullopt;
  NovelViewMetrics means;
  each_novel_view_number(means, from(json));
  means.lpips_note = text_member(json, "lpips_note");
  read_number(member(member(json, "exposure_fitted"), "psnr"), means.psnr_exposure_fitted);
  means.interpolating = read_group(member(json, "interpolating"));
  means.extrapolating = read_group(member(json, "extrapolating"));
  if (const Json& fit = member(json, "pose_refined"); fit.is_object()) {
    means.pose_refined.emplace();
    each_refined_summary_number(*means.pose_refined, from(fit));
  }
  return means;
}

/// The distances of names such as "fscore_2cm", in metres, smallest first.
std::set<double> finer_thresholds(const Json& json) {
  constexpr std::string_view kBegin = "fscore_", kEnd = "cm";
  std::set<double> thresholds;
  for (const auto& [name, value] : json.items()) {
    if (name.size() <= kBegin.size() + kEnd.size() || name.compare(0, kBegin.size(), kBegin) != 0 ||
        name.compare(name.size() - kEnd.size(), kEnd.size(), kEnd) != 0)
      continue;
    const std::string digits = name.substr(kBegin.size(), name.size() - kBegin.size() - kEnd.size());
    char* end = nullptr;
    const double centimetres = std::strtod(digits.c_str(), &end);
    if (*end == '\0' && centimetres > 0) thresholds.insert(centimetres / 100);
  }
  return thresholds;
}

/// The inverse of protocol_text().
void take_protocol(const std::string& text, MeshProtocolResult& result) {
  const size_t culling = text.find(kCullingMark), alignment = text.rfind(kAlignmentMark);
  result.stated = text;
  if (alignment == std::string::npos || culling >= alignment) return;
  const size_t poses = culling + kCullingMark.size();
  const auto protocol = choice_named<MeshProtocol>(text.substr(0, culling));
  const auto views = choice_named<CullingViews>(text.substr(poses, alignment - poses));
  const auto aligned = choice_named<MeshAlignment>(text.substr(alignment + kAlignmentMark.size()));
  if (!protocol || !views || !aligned) return;
  result.protocol = *protocol;
  result.culling = *views;
  result.alignment = *aligned;
  result.stated.reset();
}

MeshProtocolResult read_protocol(const Json& json) {
  MeshProtocolResult result;
  take_protocol(text_member(json, "protocol"), result);
  each_mesh_number(result, from(json));
  for (const double threshold : finer_thresholds(json)) {
    ThresholdScores finer;
    finer.threshold = threshold;
    each_finer_number(finer, from(json));
    result.scores.finer.push_back(finer);
  }
  if (!member(json, "icp_rmse_m").is_null()) {
    result.alignment_report.icp.emplace();
    read_number(member(json, "icp_rmse_m"), result.alignment_report.icp->rmse_after);
  }
  return result;
}

std::optional<MeshEvaluation> read_geometry(const Json& json) {
  if (!json.is_object()) return std::nullopt;
  MeshEvaluation evaluation;
  evaluation.headline = read_protocol(json);
  each_surface_number(evaluation.surface, from(member(json, "surface")));
  const Json& variants = member(json, "variants");
  if (!variants.is_array()) return evaluation;
  for (const Json& variant : variants) {
    if (variant.is_object()) evaluation.variants.push_back(read_protocol(variant));
  }
  return evaluation;
}

}  // namespace

RunMetrics metrics_from_json(const Json& json) {
  RunMetrics metrics;
  metrics.scene_source = text_member(json, "scene_source");
  metrics.priors = text_member(json, "priors");
  read_number(member(json, "width"), metrics.width);
  read_number(member(json, "height"), metrics.height);
  metrics.novel_views = read_novel_views(member(json, "nvs"));
  metrics.geometry = read_geometry(member(json, "geometry"));
  read_semantics(member(json, "semantics"), metrics);
  each_training_number(metrics.train, from(member(json, "train")));
  metrics.train.device = text_member(member(json, "train"), "device");
  const Json& views = member(json, "per_view");
  if (!views.is_array()) return metrics;
  for (const Json& view : views) {
    if (view.is_object()) metrics.views.push_back(read_view(view));
  }
  return metrics;
}

RunMetrics read_metrics(const std::filesystem::path& file) {
  const Json json = parse_json(read_file(file));
  if (!json.is_object()) {
    throw_bad_input(file, "metrics.json", json.is_discarded() ? "is not JSON" : "is JSON, but no object",
                    "measure again with `aligngs eval`");
  }
  return metrics_from_json(json);
}

}  // namespace aligngs
