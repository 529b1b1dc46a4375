#include "mesh/face_filter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "core/error.h"
#include "scene/face_neighbours.h"

namespace aligngs {
namespace {

constexpr size_t kFaceGrain = 8192;

/// A weight below is as good as none, and its exponential need not be formed.
constexpr float kLeastExponent = -12;

float gaussian(float squared, float scale) {
  const float exponent = squared * scale;
  return exponent > kLeastExponent ? std::exp(exponent) : 0;
}

class FaceFilter {
 public:
  FaceFilter(TriangleMesh& mesh, const FaceFilterOptions& options, ThreadPool& pool)
      : mesh_(mesh),
        options_(options),
        pool_(pool),
        count_(mesh.triangles.size()),
        neighbours_(face_neighbours(mesh, CrowdedEdge::kJoinsNone)) {
    find_faces_of_vertices();
    measure_faces();
  }

  void run() {
    weigh_distances();
    for (int round = 0; round < options_.rounds; ++round) filter_normals();
    const std::vector<Vec3f> start = mesh_.vertices;
    for (int round = 0; round < options_.vertex_rounds; ++round) move_vertices();
    if (options_.max_shift > 0) limit_shifts(start);
    if (!mesh_.normals.empty()) set_vertex_normals();
  }

 private:
  void find_faces_of_vertices() {
    first_face_.assign(mesh_.vertices.size() + 1, 0);
    for (const auto& t : mesh_.triangles) {
      for (const uint32_t v : t) ++first_face_[v + 1];
    }
    std::partial_sum(first_face_.begin(), first_face_.end(), first_face_.begin());
    faces_.resize(3 * count_);
    std::vector<uint32_t> next(first_face_.begin(), first_face_.end() - 1);
    for (uint32_t f = 0; f < count_; ++f) {
      for (const uint32_t v : mesh_.triangles[f]) faces_[next[v]++] = f;
    }
  }

  template <class Body>
  void for_each(size_t count, const Body& body) {
    pool_.parallel_for(count, kFaceGrain, [&](size_t begin, size_t end, int) {
      for (size_t i = begin; i < end; ++i) body(i);
    });
  }

  Vec3f centre_of(size_t face) const {
    const auto& t = mesh_.triangles[face];
    return (mesh_.vertices[t[0]] + mesh_.vertices[t[1]] + mesh_.vertices[t[2]]) * (1.0f / 3);
  }

  void measure_faces() {
    centres_.resize(count_);
    normals_.resize(count_);
    areas_.resize(count_);
    for_each(count_, [&](size_t f) {
      const auto& t = mesh_.triangles[f];
      const Vec3f a = mesh_.vertices[t[0]];
      const Vec3f twice = cross(mesh_.vertices[t[1]] - a, mesh_.vertices[t[2]] - a);
      centres_[f] = centre_of(f);
      areas_[f] = 0.5f * norm(twice);
      normals_[f] = areas_[f] > 0 ? normalized(twice) : Vec3f{};
    });
  }

  /// Weights of neighbours by distance and area: the same in every round.
  void weigh_distances() {
    double sum = 0;
    size_t pairs = 0;
    for (size_t f = 0; f < count_; ++f) {
      for (const uint32_t n : neighbours_[f]) {
        if (n == kNoFace) continue;
        sum += static_cast<double>(norm(centres_[n] - centres_[f]));
        ++pairs;
      }
    }
    const double sigma = options_.distance_sigma * (pairs ? sum / static_cast<double>(pairs) : 0);
    const float scale = sigma > 0 ? static_cast<float>(-0.5 / (sigma * sigma)) : 0;
    weights_.resize(count_);
    for_each(count_, [&](size_t f) {
      for (size_t side = 0; side < 3; ++side) {
        const uint32_t n = neighbours_[f][side];
        const Vec3f way = n == kNoFace ? Vec3f{} : centres_[n] - centres_[f];
        weights_[f][side] = n == kNoFace ? 0 : areas_[n] * gaussian(dot(way, way), scale);
      }
    });
  }

  void filter_normals() {
    const float scale = static_cast<float>(-0.5 / (options_.normal_sigma * options_.normal_sigma));
    std::vector<Vec3f> next(count_);
    for_each(count_, [&](size_t f) {
      const Vec3f own = normals_[f];
      Vec3f sum = own * areas_[f];
      for (size_t side = 0; side < 3; ++side) {
        const uint32_t n = neighbours_[f][side];
        if (n == kNoFace || areas_[n] == 0) continue;
        const Vec3f difference = normals_[n] - own;
        sum += normals_[n] * (weights_[f][side] * gaussian(dot(difference, difference), scale));
      }
      next[f] = areas_[f] > 0 ? normalized(sum) : own;
    });
    normals_ = std::move(next);
  }

  void move_vertices() {
    for_each(count_, [&](size_t f) { centres_[f] = centre_of(f); });
    for_each(mesh_.vertices.size(), [&](size_t v) {
      const Vec3f place = mesh_.vertices[v];
      Vec3f shift;
      size_t counted = 0;
      for (size_t k = first_face_[v]; k < first_face_[v + 1]; ++k) {
        const uint32_t f = faces_[k];
        if (areas_[f] == 0) continue;
        shift += normals_[f] * dot(normals_[f], centres_[f] - place);
        ++counted;
      }
      if (counted > 0) mesh_.vertices[v] = place + shift * (1.0f / static_cast<float>(counted));
    });
  }

  void limit_shifts(const std::vector<Vec3f>& start) {
    const float most = static_cast<float>(options_.max_shift);
    for_each(start.size(), [&](size_t v) {
      const Vec3f shift = mesh_.vertices[v] - start[v];
      const float length = norm(shift);
      if (length > most) mesh_.vertices[v] = start[v] + shift * (most / length);
    });
  }

  void set_vertex_normals() {
    for_each(mesh_.vertices.size(), [&](size_t v) {
      Vec3f sum;
      for (size_t k = first_face_[v]; k < first_face_[v + 1]; ++k) sum += normals_[faces_[k]] * areas_[faces_[k]];
      if (norm(sum) > 0) mesh_.normals[v] = normalized(sum);
    });
  }

  TriangleMesh& mesh_;
  const FaceFilterOptions& options_;
  ThreadPool& pool_;
  size_t count_;
  const std::vector<std::array<uint32_t, 3>> neighbours_;
  std::vector<uint32_t> first_face_, faces_;  ///< faces of a vertex: faces_[first_face_[v]] and on
  std::vector<Vec3f> centres_, normals_;      ///< normals are unit, or zero without area
  std::vector<float> areas_;                  ///< of the unfiltered faces
  std::vector<std::array<float, 3>> weights_;
};

}  // namespace

void filter_faces(TriangleMesh& mesh, const FaceFilterOptions& options, ThreadPool& pool) {
  if (options.rounds < 0 || options.vertex_rounds < 0 || !(options.normal_sigma > 0) || !(options.distance_sigma > 0))
    throw_usage("a setting of the face filter is out of range", "give rounds from 0, and sigmas above 0");
  if (options.rounds == 0 || mesh.empty()) return;
  FaceFilter(mesh, options, pool).run();
}

}  // namespace aligngs
