#include "mesh/mesh_labels.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "metrics/visibility.h"

namespace aligngs {
namespace {

constexpr size_t kVertexGrain = 2048;  // vertices per chunk
constexpr double kMinCosine = 0.05;    // a grazing look still counts a little: it may be the only one

struct Vote {
  uint16_t label;
  double weight;
};

double vote_weight(const FusionFrame& frame, int x, int y, const Vec3d& to_camera, const Vec3f* normal) {
  double weight = frame.label_probability.empty() ? 1 : frame.label_probability.at(x, y);
  if (!(weight > 0)) return 0;
  if (normal) weight *= std::max(dot(normalized(to_camera), normal->cast<double>()), kMinCosine);
  return weight;
}

uint16_t winner(std::vector<Vote>& votes) {
  std::stable_sort(votes.begin(), votes.end(), [](const Vote& a, const Vote& b) { return a.label < b.label; });
  uint16_t best = kNoLabel;
  double most = 0;
  for (size_t begin = 0; begin < votes.size();) {
    double sum = 0;
    size_t end = begin;
    for (; end < votes.size() && votes[end].label == votes[begin].label; ++end) sum += votes[end].weight;
    if (sum > most) {
      most = sum;
      best = votes[begin].label;
    }
    begin = end;
  }
  return best;
}

}  // namespace

MeshLabelingReport label_mesh(TriangleMesh& mesh, const std::vector<FusionFrame>& frames, ThreadPool& pool,
                              const MeshLabelingOptions& options) {
  check_fusion_frames(frames);
  std::vector<Vec3d> centres;
  for (const FusionFrame& frame : frames) centres.push_back(frame.camera.centre());
  const bool has_normals = mesh.normals.size() == mesh.vertices.size();
  mesh.labels.assign(mesh.vertices.size(), kNoLabel);
  pool.parallel_for(mesh.vertices.size(), kVertexGrain, [&](size_t begin, size_t end, int) {
    std::vector<Vote> votes;
    for (size_t i = begin; i < end; ++i) {
      votes.clear();
      const Vec3d vertex = mesh.vertices[i].cast<double>();
      for (size_t f = 0; f < frames.size(); ++f) {
        const FusionFrame& frame = frames[f];
        if (frame.label.empty()) continue;
        const auto uv = project_into_image(frame.camera, vertex);
        if (!uv) continue;
        const int x = static_cast<int>(uv->x), y = static_cast<int>(uv->y);
        const uint16_t label = frame.label.at(x, y);
        if (label == kNoLabel || (!frame.alpha.empty() && !(frame.alpha.at(x, y) >= options.min_alpha))) continue;
        const double depth = valid_depth(frame.depth, x, y), z = (frame.camera.world_to_camera * vertex).z;
        if (depth == 0 || std::abs(z - depth) > options.depth_tolerance * z) continue;
        const double weight = vote_weight(frame, x, y, centres[f] - vertex, has_normals ? &mesh.normals[i] : nullptr);
        if (weight > 0) votes.push_back({label, weight});
      }
      mesh.labels[i] = winner(votes);
    }
  });
  MeshLabelingReport report;
  for (const uint16_t label : mesh.labels) ++(label == kNoLabel ? report.unseen : report.labelled);
  return report;
}

}  // namespace aligngs
