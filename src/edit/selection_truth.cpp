#include "edit/selection_truth.h"

#include <algorithm>

#include "core/error.h"
#include "edit/mesh_selection.h"
#include "metrics/point_index.h"
#include "metrics/surface_points.h"
#include "metrics/visibility.h"

namespace aligngs {
namespace {

bool holds(const std::vector<SelectionTerm>& terms, uint16_t label) {
  return std::any_of(terms.begin(), terms.end(), [&](const SelectionTerm& t) { return t.label == label; });
}

std::vector<uint8_t> true_flags(const TriangleMesh& truth, const SelectionQuery& query) {
  std::vector<uint8_t> flags;
  for (const uint16_t label : truth.labels) {
    const bool in = query.everything || holds(query.include, label);
    flags.push_back(in && !holds(query.exclude, label));
  }
  return flags;
}

double share_within(const std::vector<Vec3f>& from, const PointIndex& to, double threshold, ThreadPool& pool) {
  size_t near = 0;
  for (const Nearest& n : to.nearest(from, pool)) near += n.distance <= threshold;
  return from.empty() ? 0 : static_cast<double>(near) / static_cast<double>(from.size());
}

/// The triangles with two vertices or more in the box around some meshes, widened by `margin`.
TriangleMesh near_box(const TriangleMesh& all, const std::vector<const TriangleMesh*>& around, double margin) {
  Vec3f low{1e30f, 1e30f, 1e30f}, high{-1e30f, -1e30f, -1e30f};
  for (const TriangleMesh* mesh : around) {
    for (const Vec3f& v : mesh->vertices) {
      for (int a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], v[a] - static_cast<float>(margin));
        high[a] = std::max(high[a], v[a] + static_cast<float>(margin));
      }
    }
  }
  std::vector<uint8_t> inside;
  for (const Vec3f& v : all.vertices) {
    inside.push_back(v.x >= low.x && v.y >= low.y && v.z >= low.z && v.x <= high.x && v.y <= high.y && v.z <= high.z);
  }
  return submesh(all, inside, 1);
}

SurfaceSamples sample(const TriangleMesh& mesh, const SelectionTruthOptions& options) {
  SamplingOptions sampling;
  sampling.points_per_area = options.points_per_area;
  return sample_surface(mesh, sampling);
}

/// The points that photos show.
std::vector<Vec3f> shown_points(const TriangleMesh& truth, const std::vector<Vec3f>& points,
                                const std::vector<Camera>& cameras, ThreadPool& pool) {
  const std::vector<uint8_t> seen = seen_points(RayScene(truth), cameras, points, kOwnSurface, pool);
  std::vector<Vec3f> out;
  for (size_t i = 0; i < points.size(); ++i) {
    if (seen[i]) out.push_back(points[i]);
  }
  return out;
}

}  // namespace

SelectionScore score_selection(const TriangleMesh& mesh, const std::vector<uint8_t>& flags, const TriangleMesh& truth,
                               const SelectionQuery& query, const std::vector<Camera>& cameras, ThreadPool& pool,
                               const SelectionTruthOptions& options) {
  for (const auto* terms : {&query.include, &query.exclude}) {
    for (const SelectionTerm& term : *terms) {
      if (!term.named.empty())
        throw_usage("the true mesh knows no selection that was drawn by hand", "measure a class");
      if (term.instance)
        throw_usage("the true mesh knows classes, not single objects", "measure the class without '#'");
    }
  }
  if (truth.labels.size() != truth.vertices.size()) {
    throw_bad_input({}, "label", "the true mesh has no labels", "give a mesh with a label per vertex");
  }
  const std::vector<uint8_t> wanted = true_flags(truth, query);
  const TriangleMesh true_object = submesh(truth, wanted, 1);
  const SurfaceSamples object = sample(true_object, options);
  const std::vector<Vec3f> seen = shown_points(truth, object.positions, cameras, pool);
  if (seen.empty())
    throw_bad_input({}, "--select", "no camera sees a true object of these classes", "measure other classes");
  const TriangleMesh chosen = submesh(mesh, flags, 1);
  // Other surface matters only near the two.
  const auto nearby = [&](const TriangleMesh& all) {
    return near_box(all, {&true_object, &chosen}, 2 * options.threshold);
  };
  const SurfaceSamples rest = sample(nearby(submesh(truth, wanted, 0)), options);
  const TriangleMesh other = nearby(submesh(mesh, flags, 0));
  const SurfaceSamples chosen_samples = sample(chosen, options);

  SelectionScore score;
  score.true_area = object.area * static_cast<double>(seen.size()) / static_cast<double>(object.positions.size());
  score.selected_area = chosen_samples.area;
  // Precision asks the whole object: unseen parts may still be reconstructed.
  const PointIndex object_index(object.positions), chosen_index(chosen_samples.positions);
  score.precision = share_within(chosen_samples.positions, object_index, options.threshold, pool);
  score.recall = share_within(seen, chosen_index, options.threshold, pool);
  const double p = score.precision, r = score.recall;
  score.iou = p + r > 0 ? p * r / (p + r - p * r) : 0;

  const PointIndex rest_index(rest.positions);
  double both = 0, either = 0;
  for (const bool in : {true, false}) {
    const std::vector<Vec3f> points = in ? chosen_samples.positions : sample(other, options).positions;
    const std::vector<Nearest> to_object = object_index.nearest(points, pool),
                               to_rest = rest_index.nearest(points, pool);
    for (size_t i = 0; i < points.size(); ++i) {
      if (std::min(to_object[i].distance, to_rest[i].distance) > options.threshold) continue;  // no truth here
      const bool is_object = to_object[i].distance <= to_rest[i].distance;
      both += in && is_object;
      either += in || is_object;
    }
  }
  score.label_iou = either > 0 ? both / either : 0;
  return score;
}

}  // namespace aligngs
