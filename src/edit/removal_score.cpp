#include "edit/removal_score.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/image_file.h"
#include "io/json_text.h"
#include "metrics/image_metrics.h"
#include "metrics/point_index.h"
#include "metrics/surface_points.h"
#include "metrics/visibility.h"
#include "scene/mesh_ply.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

struct TruthBox {
  Vec3f low, high;
  bool holds(const Vec3f& p, float margin) const {
    for (int a = 0; a < 3; ++a) {
      if (p[a] < low[a] - margin || p[a] > high[a] + margin) return false;
    }
    return true;
  }
};

std::vector<TruthBox> boxes_of(const fs::path& file) {
  const nlohmann::json document = parse_json(read_file(file, uint64_t(1) << 20));
  std::vector<TruthBox> boxes;
  try {
    for (const auto& object : document.at("objects")) {
      TruthBox box;
      for (int a = 0; a < 3; ++a) {
        box.low[a] = object.at("low").at(static_cast<size_t>(a)).get<float>();
        box.high[a] = object.at("high").at(static_cast<size_t>(a)).get<float>();
      }
      boxes.push_back(box);
    }
  } catch (const nlohmann::json::exception&) {
    boxes.clear();
  }
  if (boxes.empty())
    throw_bad_input(file, "objects", "objects with boxes are expected",
                    "make the truth again: aligngs synth ... --without");
  return boxes;
}

std::vector<Vec3f> in_boxes(const TriangleMesh& mesh, const std::vector<TruthBox>& boxes,
                            const RemovalScoreOptions& options) {
  SamplingOptions sampling;
  sampling.points_per_area = options.points_per_area;
  std::vector<Vec3f> out;
  for (const Vec3f& p : sample_surface(mesh, sampling).positions) {
    if (std::any_of(boxes.begin(), boxes.end(),
                    [&](const TruthBox& b) { return b.holds(p, static_cast<float>(options.threshold)); }))
      out.push_back(p);
  }
  return out;
}

double share_near(const std::vector<Vec3f>& from, const std::vector<Vec3f>& to, double threshold, ThreadPool& pool) {
  if (from.empty() || to.empty()) return 0;
  size_t near = 0;
  for (const Nearest& n : PointIndex(to).nearest(from, pool)) near += n.distance <= threshold;
  return static_cast<double>(near) / static_cast<double>(from.size());
}

void score_pictures(const fs::path& renders, const fs::path& truth, const RemovalScoreOptions& options,
                    RemovalScore& score) {
  double squares = 0, count = 0;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(truth / "mask")) files.push_back(entry.path().filename());
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    const Image<uint8_t> mask = read_image(truth / "mask" / file);
    Image<uint8_t> first(mask.width, mask.height, 1);  // of the channels, which are alike
    for (size_t p = 0; p < first.data.size(); ++p) first.data[p] = mask.data[p * static_cast<size_t>(mask.channels)];
    const ImageF wide = widened_mask(first, static_cast<int>(std::lround(options.margin * mask.width)));
    const size_t pixels = static_cast<size_t>(std::count(wide.data.begin(), wide.data.end(), 1.f));
    if (pixels < options.fewest_pixels) continue;
    const ImageF render = to_float(read_image(renders / file)), photo = to_float(read_image(truth / "rgb" / file));
    if (render.width != photo.width || render.height != photo.height) {
      throw_bad_input(renders / file, "size", "the picture has another size than the true one",
                      "render at the size of the photos");
    }
    const double psnr_here = psnr(render, photo, wide);
    squares += std::pow(10.0, -psnr_here / 10) * static_cast<double>(pixels);
    count += static_cast<double>(pixels);
    score.ssim += ssim(render, photo, wide);
    ++score.views;
  }
  if (score.views == 0)
    throw_bad_input(truth / "mask", {}, "no test view shows the object", "choose an object that test views show");
  score.psnr = -10 * std::log10(squares / count);
  score.ssim /= static_cast<double>(score.views);
}

}  // namespace

ImageF widened_mask(const Image<uint8_t>& mask, int radius) {
  ImageF out(mask.width, mask.height, 1, 0.f);
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x) {
      if (!*mask.pixel(x, y)) continue;
      for (int v = std::max(0, y - radius); v <= std::min(mask.height - 1, y + radius); ++v) {
        for (int u = std::max(0, x - radius); u <= std::min(mask.width - 1, x + radius); ++u) *out.pixel(u, v) = 1;
      }
    }
  }
  return out;
}

RemovalScore score_removal(const fs::path& renders, const fs::path& truth, const TriangleMesh& mesh,
                           const std::vector<Camera>& cameras, ThreadPool& pool, const RemovalScoreOptions& options) {
  if (!fs::exists(truth / "removal.json")) {
    throw_bad_input(truth, {}, "the scene has no truth for this removal",
                    "make it with the scene: aligngs synth ... --without OBJECT");
  }
  RemovalScore score;
  score_pictures(renders, truth, options, score);
  const std::vector<TruthBox> boxes = boxes_of(truth / "removal.json");
  const TriangleMesh true_mesh = read_mesh_ply(truth / "mesh.ply");
  const std::vector<Vec3f> all = in_boxes(true_mesh, boxes, options);
  const std::vector<uint8_t> shown = seen_points(RayScene(true_mesh), cameras, all, kOwnSurface, pool);
  std::vector<Vec3f> seen;
  for (size_t i = 0; i < all.size(); ++i) {
    if (shown[i]) seen.push_back(all[i]);
  }
  const std::vector<Vec3f> made = in_boxes(mesh, boxes, options);
  score.precision = share_near(made, all, options.threshold, pool);
  score.recall = share_near(seen, made, options.threshold, pool);
  const double sum = score.precision + score.recall;
  score.fscore = sum > 0 ? 2 * score.precision * score.recall / sum : 0;
  return score;
}

}  // namespace aligngs
