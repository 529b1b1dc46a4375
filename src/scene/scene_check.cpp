// check_scene of view_data.h: decodes every file of every view.
#include "scene/scene_check.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <thread>

#include <fmt/format.h>

#include "core/error.h"
#include "core/is_depth.h"
#include "core/median.h"
#include "core/memory_budget.h"
#include "core/thread_pool.h"
#include "io/image_file.h"
#include "scene/image_quality.h"
#include "scene/mesh_ply.h"
#include "scene/prior_maps.h"
#include "scene/segment_file.h"
#include "scene/unused_masks.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

constexpr double kBlurred = 0.25;       ///< of the median sharpness at equal brightness
constexpr double kExposureRatio = 1.6;  ///< brighter or darker than the median by this factor
constexpr size_t kMinForMedians = 4;    ///< views below which "unlike the others" means nothing
/// softmax of values within [0, 2] among 150 classes reaches at most 0.047: such numbers are hardly logits.
constexpr float kScoreLike = 2;

/// Findings of decoding the files of one view.
struct ViewFindings {
  std::vector<SceneProblem> problems;
  double sharpness = -1, luminance = -1;  ///< negative: the image could not be read
  bool has_semantics = false;
  bool score_like = false;   ///< all semantic values lie in [0, 2]
  bool other_depth = false;  ///< its depth has another unit than its points, or is no depth
};

void add(ViewFindings& findings, const fs::path& path, const char* field, std::string message, std::string remedy,
         bool fatal) {
  findings.problems.push_back({path, field, std::move(message), std::move(remedy), fatal});
}

template <class Check>
void note_error(ViewFindings& findings, const fs::path& path, Check check) {
  try {
    check();
  } catch (const Error& error) {
    const Error::Details& d = error.details();
    findings.problems.push_back({d.path.empty() ? path : d.path, d.field, d.message, d.remedy, true});
  }
}

void check_image(const View& view, int width, ViewFindings& findings) {
  const Image<uint8_t> image = read_view_photo(view);
  findings.sharpness = sharpness(image, width);
  findings.luminance = mean_luminance(image);
  if (!view.mask.empty()) {
    const Image<uint8_t> mask = read_view_mask(view, view.camera.width, view.camera.height);
    if (std::none_of(mask.data.begin(), mask.data.end(), [](uint8_t value) { return value != 0; })) {
      add(findings, view.mask, "values", "the mask hides the whole photo", "remove the mask or the view", true);
    }
  }
  if (image.channels != 4) return;
  const bool used = std::any_of(image.data.begin(), image.data.end(),
                                [&, i = size_t(0)](uint8_t value) mutable { return i++ % 4 == 3 && value >= 128; });
  if (!used) {
    add(findings, view.image, "alpha", "the mask hides the whole image",
        "remove the mask of this photo (its alpha channel, or its file in masks/), or leave the photo out", true);
  }
}

void check_depth(const Scene& scene, const View& view, ViewFindings& findings) {
  FloatArray array = read_map(view.prior_depth);
  const MapShape shape = depth_map_shape(array.shape, view.prior_depth);
  size_t valid = 0, negative = 0;
  float low = 0, high = 0;
  for (float z : array.data) {
    negative += z < 0;
    if (!is_depth(z)) continue;
    low = valid == 0 ? z : std::min(low, z);
    high = std::max(high, z);
    ++valid;
  }
  const char* recompute = "compute this map again, or remove it";
  if (valid == 0) {
    if (scene.prior_source == kStereoDepth) return;  // a photo that shares nothing with the others
    add(findings, view.prior_depth, "values", "no pixel has a depth (all are zero, negative or not finite)", recompute,
        true);
    return;
  }
  if (negative > 0) {
    add(findings, view.prior_depth, "values", fmt::format("{} pixels are negative and count as no value", negative),
        "write 0 where there is no depth", false);
  }
  if (low == high) {
    add(findings, view.prior_depth, "values", "every depth is the same number", recompute, false);
    return;
  }
  ImageF depth;
  depth.width = shape.width;
  depth.height = shape.height;
  depth.channels = 1;
  depth.data = std::move(array.data);
  const DisparityEvidence evidence = disparity_evidence(scene.cloud, view.camera, depth);
  findings.other_depth = evidence.is_disparity() || evidence.has_other_unit();
  if (const auto turned = evidence.is_disparity() ? turned_map(scene.cloud, view.camera, depth) : std::nullopt) {
    add(findings, view.prior_depth, "values", "the map is " + *turned + ": it fits the points the other way round",
        "write its rows and columns in the order of the photo", true);
  } else if (evidence.is_disparity()) {
    add(findings, view.prior_depth, "values",
        fmt::format("larger values are nearer (rank correlation {:.2f} with the depth of {} points): this is "
                    "disparity or inverse depth, not depth",
                    evidence.rank_correlation, evidence.points),
        "write depth: 1 / (disparity * scale + shift), larger is farther", true);
  } else if (scene.depth_scale == DepthScale::kScene && evidence.has_other_unit()) {
    add(findings, view.prior_depth, "values",
        fmt::format("the depth is {:.3g} times that of {} points, although it counts as in scene units", evidence.ratio,
                    evidence.points),
        "write it in scene units, or set \"scale\": \"own\" in priors.json", false);
  }
}

/// A map that trusts no pixel takes all depth of its view away.
void check_confidence(const Scene& scene, const View& view, ViewFindings& findings) {
  const std::filesystem::path path = scene.folder / "pred_confidence" / (view.name + ".npy");
  std::error_code unreadable;
  if (!std::filesystem::is_regular_file(path, unreadable) || scene.prior_source == kStereoDepth) return;
  const FloatArray array = read_map(path);
  if (std::none_of(array.data.begin(), array.data.end(), [](float value) { return value > 0; })) {
    add(findings, path, "values", "no pixel has a confidence above 0, so no depth of this view is used",
        "compute this map again, or remove it", false);
  }
}

void check_semantics(const Scene& scene, const View& view, ViewFindings& findings) {
  const FloatArray array = read_map(view.semantics);
  semantic_map_shape(array.shape, scene.labels.size(), view.semantics);
  size_t bad = 0;
  float low = 0, high = 0;
  for (float v : array.data) {
    bad += !std::isfinite(v);
    if (!std::isfinite(v)) continue;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  findings.has_semantics = true;
  findings.score_like = low >= 0 && high <= kScoreLike;
  const char* recompute = "compute this map again, or remove it";
  if (bad == array.data.size()) {
    add(findings, view.semantics, "values", "no value is finite", recompute, true);
  } else if (bad > 0) {
    add(findings, view.semantics, "values", fmt::format("{} values are not finite; their pixels are not used", bad),
        recompute, false);
  }
  if (scene.semantic_kind != SemanticKind::kLogits && high <= 0 && bad < array.data.size()) {
    add(findings, view.semantics, "values", "no class has a positive value anywhere", recompute, true);
  }
}

void check_truth(const Scene& scene, int index, ViewFindings& findings) {
  const View& view = scene.views[index];
  if (!view.truth_depth.empty()) {
    note_error(findings, view.truth_depth, [&] { load_truth_depth(scene, index, view.camera); });
  }
  if (!view.truth_labels.empty()) {
    note_error(findings, view.truth_labels, [&] { load_truth_labels(scene, index, view.camera); });
  }
}

/// Decodes the files of one view; files that a problem was already found for are left out.
/// Pixels: the width at which photos of several sizes compare.
int width_to_compare(const Scene& scene, const std::vector<int>& used) {
  int width = kSharpnessWidth;
  for (const int view : used) width = std::min(width, scene.views[static_cast<size_t>(view)].camera.width);
  return width;
}

ViewFindings check_view(const Scene& scene, int index, int width, const std::vector<SceneProblem>& known) {
  const View& view = scene.views[index];
  const auto good = [&](const fs::path& path) {
    return !path.empty() &&
           std::none_of(known.begin(), known.end(), [&](const SceneProblem& p) { return p.path == path; });
  };
  ViewFindings findings;
  if (good(view.image)) note_error(findings, view.image, [&] { check_image(view, width, findings); });
  if (good(view.prior_depth)) {
    note_error(findings, view.prior_depth, [&] { check_depth(scene, view, findings); });
    note_error(findings, view.prior_depth, [&] { check_confidence(scene, view, findings); });
  }
  if (good(view.semantics)) note_error(findings, view.semantics, [&] { check_semantics(scene, view, findings); });
  if (const fs::path file = segment_file_of(scene, view); fs::is_regular_file(file) && good(file))
    note_error(findings, file, [&] { read_segments(file, scene.labels.size()); });
  check_truth(scene, index, findings);
  for (SceneProblem& problem : findings.problems) problem.view = view.name;
  return findings;
}

/// As many threads as the largest map, decoded (file bytes and float32), leaves room for.
int thread_count(const Scene& scene, const std::vector<int>& used) {
  uintmax_t largest = 1;
  for (int i : used) {
    for (const fs::path* path : {&scene.views[i].image, &scene.views[i].prior_depth, &scene.views[i].semantics}) {
      std::error_code error;
      const uintmax_t size = path->empty() ? 0 : fs::file_size(*path, error);
      if (!error) largest = std::max(largest, size);
    }
  }
  constexpr uint64_t kExpansion = 8;  // float16 or JPEG file, its bytes and its floats, with some room
  const uint64_t fit = available_memory_bytes() / (largest * kExpansion);
  const uint64_t threads = std::max(1u, std::thread::hardware_concurrency());
  return static_cast<int>(std::clamp<uint64_t>(fit, 1, threads));
}

/// Sharpness without the effect of exposure: a gain g scales the Laplacian's variance by g^2.
double relative_sharpness(const ViewFindings& findings) {
  const double brightness = std::max(findings.luminance, 1e-3);
  return findings.sharpness / (brightness * brightness);
}

/// Views that are blurred or exposed unlike the others.
void compare_images(const Scene& scene, const std::vector<int>& used, const std::vector<ViewFindings>& findings,
                    std::vector<SceneProblem>& problems) {
  std::vector<double> sharp, bright;
  for (const ViewFindings& f : findings) {
    if (f.sharpness < 0) continue;
    sharp.push_back(relative_sharpness(f));
    bright.push_back(f.luminance);
  }
  if (sharp.size() < kMinForMedians) return;
  const double median_sharpness = median_of(sharp), median_luminance = median_of(bright);
  for (size_t k = 0; k < used.size(); ++k) {
    const ViewFindings& f = findings[k];
    if (f.sharpness < 0) continue;
    const fs::path& path = scene.views[used[k]].image;
    if (relative_sharpness(f) < kBlurred * median_sharpness) {
      problems.push_back({path, "sharpness",
                          fmt::format("blurred: {:.2f} of the median sharpness of the views",
                                      relative_sharpness(f) / std::max(median_sharpness, 1e-12)),
                          "take a sharper photo from there, or leave the view out", false});
    }
    const double ratio = f.luminance / std::max(median_luminance, 1e-6);
    if (ratio > kExposureRatio || ratio < 1 / kExposureRatio) {
      problems.push_back({path, "exposure", fmt::format("{:.2f} times as bright as the median of the views", ratio),
                          "fix the exposure while taking photos, or leave the view out", false});
    }
  }
}

void check_semantic_kind(const Scene& scene, const std::vector<ViewFindings>& findings,
                         std::vector<SceneProblem>& problems) {
  if (scene.semantic_kind_stated) return;
  bool any = false;
  for (const ViewFindings& f : findings) {
    if (f.has_semantics && !f.score_like) return;
    any |= f.has_semantics;
  }
  if (!any) return;
  problems.push_back({scene.folder / "priors.json", "semantics.kind",
                      "all semantic values lie in [0, 2]: these are hardly logits, and their softmax is almost uniform",
                      "write {\"semantics\": {\"kind\": \"scores\"}} or \"probabilities\" into priors.json", false});
}

}  // namespace

std::vector<SceneProblem> check_scene(const Scene& scene) {
  std::vector<SceneProblem> problems = check_headers(scene);
  std::vector<int> used = scene.train;
  used.insert(used.end(), scene.test.begin(), scene.test.end());
  std::sort(used.begin(), used.end());

  std::vector<ViewFindings> findings(used.size());
  ThreadPool pool(thread_count(scene, used));
  const std::vector<SceneProblem> known = problems;
  const int width = width_to_compare(scene, used);
  pool.parallel_for(used.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t k = begin; k < end; ++k) findings[k] = check_view(scene, used[k], width, known);
  });
  for (ViewFindings& f : findings) {
    std::move(f.problems.begin(), f.problems.end(), std::back_inserter(problems));
  }
  if (!scene.truth_mesh.empty()) {
    try {
      read_mesh_ply(scene.truth_mesh);
    } catch (const Error& error) {
      problems.push_back(
          {scene.truth_mesh, error.details().field, error.details().message, error.details().remedy, true});
    }
  }
  std::vector<fs::path> photos;
  for (const View& view : scene.views) photos.push_back(view.image);
  for (SceneProblem& problem : unused_masks(scene.folder, photos)) problems.push_back(std::move(problem));
  compare_images(scene, used, findings, problems);
  check_semantic_kind(scene, findings, problems);
  const bool depth_is_told = std::any_of(findings.begin(), findings.end(), [](const auto& f) { return f.other_depth; });
  for (const auto& check : {depth_is_told ? nullptr : check_depth_of_views, check_geometry}) {
    if (!check) continue;
    std::vector<SceneProblem> found = check(scene);
    std::move(found.begin(), found.end(), std::back_inserter(problems));
  }
  return problems;
}

}  // namespace aligngs
