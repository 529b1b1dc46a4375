#include "mesh/charts.h"

#include <numeric>
#include <tuple>

#include "core/quaternion.h"
#include "scene/face_neighbours.h"

namespace aligngs {
namespace {

constexpr int kAngles = 18;  // turns of a chart that are tried: every 5 degrees of a quarter

Vec3d area_normal(const TriangleMesh& mesh, size_t t) {
  const auto& c = mesh.triangles[t];
  const Vec3d a = mesh.vertices[c[0]].cast<double>();
  return cross(mesh.vertices[c[1]].cast<double>() - a, mesh.vertices[c[2]].cast<double>() - a);
}

Vec3d unit_or(const Vec3d& v, const Vec3d& other) {
  const double length = norm(v);
  return length > 0 ? v * (1 / length) : other;
}

/// face_neighbours() in the same part.
std::vector<std::array<uint32_t, 3>> neighbours_of(const TriangleMesh& mesh, const std::vector<uint32_t>& part) {
  std::vector<std::array<uint32_t, 3>> out = face_neighbours(mesh, CrowdedEdge::kJoinsFirstTwo);
  for (size_t t = 0; t < out.size(); ++t) {
    for (uint32_t& n : out[t]) {
      if (n != kNoFace && part[n] != part[t]) n = kNoFace;
    }
  }
  return out;
}

class Grower {
 public:
  Grower(const TriangleMesh& mesh, const std::vector<uint32_t>& part, double texel, const AtlasSettings& settings)
      : mesh_(mesh),
        settings_(settings),
        texel_(texel),
        next_(neighbours_of(mesh, part)),
        taken_(mesh.triangles.size(), 0) {
    for (size_t t = 0; t < mesh.triangles.size(); ++t) area_.push_back(area_normal(mesh, t));
    smooth_ = area_;
    for (int round = 0; round < kSmoothing; ++round) {
      std::vector<Vec3d> sum = smooth_;
      for (size_t t = 0; t < sum.size(); ++t) {
        for (const uint32_t n : next_[t]) {
          if (n != kNoFace) sum[t] += smooth_[n];
        }
      }
      smooth_ = std::move(sum);
    }
    for (size_t t = 0; t < area_.size(); ++t) {
      face_.push_back(unit_or(area_[t], {0, 0, 1}));
      smooth_[t] = unit_or(smooth_[t], face_[t]);
    }
  }

  std::vector<FlatChart> charts() {
    std::vector<uint32_t> seeds(area_.size());
    std::iota(seeds.begin(), seeds.end(), 0u);
    std::stable_sort(seeds.begin(), seeds.end(),
                     [&](uint32_t a, uint32_t b) { return norm(area_[a]) > norm(area_[b]); });
    std::vector<FlatChart> out;
    for (const uint32_t seed : seeds) {
      // A triangle that folds over its chart is left to a chart of its own: it is still a seed.
      if (!taken_[seed]) out.push_back(grown(seed));
    }
    return out;
  }

 private:
  static constexpr int kSmoothing = 2;
  static constexpr double kFirstCosine = 0.9;  // of the triangles that give a chart its normal: 26 degrees

  template <class Accept>
  std::vector<uint32_t> flood(uint32_t seed, Accept&& accept) {
    std::vector<uint32_t> found{seed};
    taken_[seed] = 1;
    for (size_t i = 0; i < found.size(); ++i) {
      for (const uint32_t n : next_[found[i]]) {
        if (n == kNoFace || taken_[n] || !accept(n)) continue;
        taken_[n] = 1;
        found.push_back(n);
      }
    }
    return found;
  }

  FlatChart grown(uint32_t seed) {
    FlatChart chart;
    const Vec3d first = smooth_[seed];
    const std::vector<uint32_t> core = flood(seed, [&](uint32_t t) {
      return dot(smooth_[t], first) > kFirstCosine && dot(face_[t], first) > settings_.smooth_cosine;
    });
    Vec3d sum;
    for (const uint32_t t : core) {
      sum += area_[t];
      taken_[t] = 0;
    }
    chart.normal = unit_or(sum, face_[seed]);
    if (dot(chart.normal, face_[seed]) <= settings_.flat_cosine) chart.normal = face_[seed];
    chart.triangles = flood(seed, [&](uint32_t t) {
      return dot(face_[t], chart.normal) > settings_.flat_cosine &&
             dot(smooth_[t], chart.normal) > settings_.smooth_cosine;
    });
    project(chart);
    drop_folds(chart);
    return chart;
  }

  void project(FlatChart& chart) const {
    const Vec3d helper = std::abs(chart.normal.x) < 0.7 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
    const Vec3d u = normalized(cross(helper, chart.normal)), v = cross(chart.normal, u);
    for (const uint32_t t : chart.triangles) {
      auto& corners = chart.corners.emplace_back();
      for (size_t i = 0; i < 3; ++i) {
        const Vec3d p = mesh_.vertices[mesh_.triangles[t][i]].cast<double>();
        corners[i] = {dot(p, u), dot(p, v)};
      }
    }
    double best = 1e300, turn = 0;
    for (int k = 0; k < kAngles; ++k) {
      const double angle = k * 0.5 * M_PI / kAngles;
      const auto [low, high] = box(chart, angle);
      const double area = (high[0] - low[0]) * (high[1] - low[1]);
      if (area < best * (1 - 1e-9)) best = area, turn = angle;
    }
    auto [low, high] = box(chart, turn);
    if (high[1] - low[1] > high[0] - low[0]) {  // lying rectangles pack into low rows
      turn += 0.5 * M_PI;
      std::tie(low, high) = box(chart, turn);
    }
    for (auto& corners : chart.corners) {
      for (auto& c : corners) {
        const auto t = turned(c, turn);
        c = {t[0] - low[0], t[1] - low[1]};
      }
    }
    chart.width = high[0] - low[0];
    chart.height = high[1] - low[1];
  }

  static std::array<double, 2> turned(const std::array<double, 2>& p, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return {c * p[0] + s * p[1], c * p[1] - s * p[0]};
  }
  static std::pair<std::array<double, 2>, std::array<double, 2>> box(const FlatChart& chart, double angle) {
    std::array<double, 2> low{1e300, 1e300}, high{-1e300, -1e300};
    for (const auto& corners : chart.corners) {
      for (const auto& c : corners) {
        const auto t = turned(c, angle);
        for (size_t a = 0; a < 2; ++a) {
          low[a] = std::min(low[a], t[a]);
          high[a] = std::max(high[a], t[a]);
        }
      }
    }
    return {low, high};
  }

  /// Gives triangles back that cover a cell which another one of the chart has.
  void drop_folds(FlatChart& chart) {
    const size_t columns = static_cast<size_t>(chart.width / texel_) + 2,
                 rows = static_cast<size_t>(chart.height / texel_) + 2;
    std::vector<uint8_t> covered(columns * rows, 0);
    size_t kept = 0;
    for (size_t k = 0; k < chart.triangles.size(); ++k) {
      auto corners = chart.corners[k];
      for (auto& c : corners) c = {c[0] / texel_, c[1] / texel_};
      std::vector<size_t> cells;
      bool folds = false;
      for_cells(corners, 0, [&](int x, int y, const std::array<double, 3>& w) {
        constexpr double kInside = 1e-6;  // a centre on a common edge is in neither triangle
        if (w[0] < kInside || w[1] < kInside || w[2] < kInside) return;
        cells.push_back(static_cast<size_t>(y) * columns + static_cast<size_t>(x));
        folds |= covered[cells.back()] != 0;
      });
      if (folds) {
        taken_[chart.triangles[k]] = 0;
        continue;
      }
      for (const size_t cell : cells) covered[cell] = 1;
      chart.triangles[kept] = chart.triangles[k];
      chart.corners[kept++] = chart.corners[k];
    }
    chart.triangles.resize(kept);
    chart.corners.resize(kept);
  }

  const TriangleMesh& mesh_;
  const AtlasSettings& settings_;
  double texel_;
  std::vector<std::array<uint32_t, 3>> next_;
  std::vector<uint8_t> taken_;
  std::vector<Vec3d> area_, face_, smooth_;
};

}  // namespace

std::vector<FlatChart> flat_charts(const TriangleMesh& mesh, const std::vector<uint32_t>& part, double texel,
                                   const AtlasSettings& settings) {
  return Grower(mesh, part, texel, settings).charts();
}

}  // namespace aligngs
