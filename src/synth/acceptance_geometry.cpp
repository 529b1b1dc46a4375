#include <algorithm>
#include <cmath>

#include "core/angles.h"
#include "core/median.h"
#include "core/quantile.h"
#include "scene/kd_tree.h"
#include "synth/acceptance_measures.h"

namespace aligngs {
namespace {

constexpr int kStep = 2;                    // pixels between the points that form a cloud
constexpr size_t kMaxQueries = 60000;       // nearest-neighbour questions per direction
constexpr double kConfidentQuantile = 0.3;  // pixels below a view's quantile of confidence are not fused
constexpr size_t kFewViews = 4;             // per group in the few-view figures

/// Distances of (a regular subset of) `from` to their nearest neighbours in `to`.
std::vector<double> nearest_distances(const std::vector<Vec3d>& from, const std::vector<Vec3d>& to, ThreadPool& pool) {
  if (to.empty() || from.empty()) return {};
  const KdTree<double> tree(to);
  const size_t step = std::max<size_t>(1, from.size() / kMaxQueries), n = (from.size() + step - 1) / step;
  std::vector<double> out(n);
  pool.parallel_for(n, 1024, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      uint32_t index = 0;
      double d2 = 0;
      tree.nearest(from[i * step], 1, &index, &d2);
      out[i] = std::sqrt(d2);
    }
  });
  return out;
}

double mean_of(const std::vector<double>& v) {
  double sum = 0;
  for (const double x : v) sum += x;
  return v.empty() ? 0 : sum / static_cast<double>(v.size());
}

float quantile(const ImageF& confidence, double q) {
  std::vector<float> known;
  for (const float c : confidence.data) {
    if (c > 0) known.push_back(c);
  }
  return lower_rank_of(std::move(known), q);
}

std::vector<double> ranks(const std::vector<double>& values) {
  std::vector<uint32_t> order(values.size());
  for (uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(),
            [&](uint32_t a, uint32_t b) { return values[a] != values[b] ? values[a] < values[b] : a < b; });
  std::vector<double> out(values.size());
  for (size_t r = 0; r < order.size(); ++r) out[order[r]] = static_cast<double>(r);
  return out;
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const double ma = mean_of(a), mb = mean_of(b);
  double ab = 0, aa = 0, bb = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    ab += (a[i] - ma) * (b[i] - mb);
    aa += (a[i] - ma) * (a[i] - ma);
    bb += (b[i] - mb) * (b[i] - mb);
  }
  return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0;
}

double angle_degrees(const Vec3d& a, const Vec3d& b) { return std::atan2(norm(cross(a, b)), dot(a, b)) * 180 / kPi; }

}  // namespace

namespace {

/// Teacher's confident points, the true points of the same pixels, and the true points of all pixels of some views.
/// Glass, screens and black gloss are left out: the depth sensors behind the published figures have no value there.
struct PointPairs {
  std::vector<Vec3d> said, truth, surface;
  std::vector<Rigidd> teacher_poses, true_poses;
};

PointPairs collect(const SynthScene& scene, const std::vector<int>& views) {
  PointPairs p;
  for (const int i : views) {
    const SynthView& view = scene.views[static_cast<size_t>(i)];
    const Camera &t = view.teacher.camera, &e = view.truth.camera;
    p.teacher_poses.push_back(t.world_to_camera);
    p.true_poses.push_back(e.world_to_camera);
    const float least = quantile(view.teacher.confidence, kConfidentQuantile);
    for (int y = kStep / 2; y < e.height; y += kStep) {
      for (int x = kStep / 2; x < e.width; x += kStep) {
        const float z = view.truth.depth.at(x, y), d = view.teacher.depth.at(x, y);
        if (!(z > 0) || !(d > 0) || view.truth.unreliable.at(x, y) != 0) continue;
        p.surface.push_back(e.unproject(x + 0.5, y + 0.5, z));
        if (view.teacher.confidence.at(x, y) < least) continue;
        p.truth.push_back(p.surface.back());
        p.said.push_back(t.unproject(x + 0.5, y + 0.5, d));
      }
    }
  }
  return p;
}

/// The similarity that fits corresponding points best, without the worst tenth (flying pixels).
Similarity align_points(const PointPairs& p) {
  Similarity best = fit_similarity(p.said, p.truth).similarity;
  for (int round = 0; round < 2; ++round) {
    std::vector<double> residuals;
    for (size_t i = 0; i < p.said.size(); ++i) residuals.push_back(norm(best * p.said[i] - p.truth[i]));
    std::vector<double> sorted = residuals;
    const size_t k = sorted.size() * 9 / 10;
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(k), sorted.end());
    std::vector<Vec3d> from, to;
    for (size_t i = 0; i < p.said.size(); ++i) {
      if (residuals[i] <= sorted[k]) from.push_back(p.said[i]), to.push_back(p.truth[i]);
    }
    best = fit_similarity(from, to).similarity;
  }
  return best;
}

std::vector<Vec3d> transformed(const std::vector<Vec3d>& points, const Similarity& s) {
  std::vector<Vec3d> out;
  out.reserve(points.size());
  for (const Vec3d& p : points) out.push_back(s * p);
  return out;
}

}  // namespace

FusedPointFigures measure_fused_points(const SynthScene& scene, ThreadPool& pool) {
  FusedPointFigures f;
  const PointPairs all = collect(scene, scene.train);
  if (all.said.empty()) return f;
  const std::vector<Vec3d> truth = transformed(all.surface, {});
  const Similarity best = align_points(all);
  const std::vector<Vec3d> aligned = transformed(all.said, best);
  const std::vector<double> accuracy = nearest_distances(aligned, truth, pool);
  f.accuracy_mean = mean_of(accuracy);
  f.accuracy_median = median_of(accuracy);
  f.completeness_mean = mean_of(nearest_distances(truth, aligned, pool));
  const Similarity cameras = fit_similarity_of_cameras(all.teacher_poses, all.true_poses).similarity;
  f.accuracy_on_cameras = mean_of(nearest_distances(transformed(all.said, cameras), truth, pool));
  // Completeness as published, on few views: another view rarely fills what one view gets wrong.
  const size_t groups = std::max<size_t>(1, scene.train.size() / kFewViews);
  for (size_t g = 0; g < groups; ++g) {
    std::vector<int> few;
    for (size_t i = g; i < scene.train.size(); i += groups) few.push_back(scene.train[i]);
    const PointPairs part = collect(scene, few);
    if (part.said.empty()) continue;
    const std::vector<Vec3d> part_truth = transformed(part.surface, {}),
                             part_said = transformed(part.said, align_points(part));
    f.few_view_accuracy += mean_of(nearest_distances(part_said, part_truth, pool)) / static_cast<double>(groups);
    f.few_view_completeness += mean_of(nearest_distances(part_truth, part_said, pool)) / static_cast<double>(groups);
  }
  return f;
}

PoseFigures measure_pair_poses(const SynthScene& scene) {
  PoseFigures f;
  double count = 0, beyond = 0;
  for (size_t a = 0; a < scene.train.size(); ++a) {
    const SynthView& va = scene.views[static_cast<size_t>(scene.train[a])];
    f.focal += std::fabs(va.teacher.camera.fx / va.truth.camera.fx - 1) / static_cast<double>(scene.train.size());
    for (size_t b = a + 1; b < scene.train.size(); ++b) {
      const SynthView& vb = scene.views[static_cast<size_t>(scene.train[b])];
      const Rigidd t = vb.teacher.camera.world_to_camera * va.teacher.camera.world_to_camera.inverse();
      const Rigidd e = vb.truth.camera.world_to_camera * va.truth.camera.world_to_camera.inverse();
      double error = rotation_angle_between_degrees(t.rotation, e.rotation);
      if (norm(e.translation) > 0.05) error = std::max(error, angle_degrees(t.translation, e.translation));
      f.mean += error;
      f.clipped_mean += std::min(error, 3.0);
      beyond += std::min(error, 30.0) / 30;
      count += 1;
    }
  }
  if (count > 0) f.mean /= count, f.clipped_mean /= count, f.auc_30 = 1 - beyond / count;
  return f;
}

double measure_confidence(const SynthScene& scene) {
  double sum = 0;
  for (const int i : scene.train) {
    const SynthView& view = scene.views[static_cast<size_t>(i)];
    std::vector<double> errors, confidence;
    for (size_t p = 0; p < view.teacher.own_error.data.size(); p += 3) {
      if (!(view.teacher.depth.data[p] > 0)) continue;
      errors.push_back(view.teacher.own_error.data[p]);
      confidence.push_back(view.teacher.confidence.data[p]);
    }
    sum -= correlation(ranks(errors), ranks(confidence));
  }
  return scene.train.empty() ? 0 : sum / static_cast<double>(scene.train.size());
}

MonoFigures measure_mono_depth(const SynthScene& scene) {
  MonoFigures f;
  double views = 0;
  for (const SynthView& view : scene.views) {
    if (view.mono_depth.empty()) continue;
    std::vector<double> a, b;
    double squares = 0;
    for (size_t p = 0; p < view.truth.depth.data.size(); ++p) {
      if (!(view.truth.depth.data[p] > 0)) continue;
      a.push_back(view.mono_depth.data[p]);
      b.push_back(view.truth.depth.data[p]);
      squares += (a.back() - b.back()) * (a.back() - b.back());
    }
    if (a.empty()) continue;
    f.rmse += std::sqrt(squares / static_cast<double>(a.size()));
    f.pearson += correlation(a, b);
    views += 1;
  }
  if (views > 0) f.rmse /= views, f.pearson /= views;
  return f;
}

}  // namespace aligngs
