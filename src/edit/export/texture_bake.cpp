#include "edit/export/texture_bake.h"

#include <algorithm>
#include <cmath>

#include "edit/export/photo_weight.h"
#include "gaussians/point_tree.h"
#include "gaussians/soft_labels.h"
#include "mesh/charts.h"

namespace aligngs {
namespace {

constexpr uint32_t kNone = 0xffffffffu;

/// The surface at each texel of a chart's rectangle, row by row.
struct Texels {
  std::vector<uint32_t> triangle;  ///< kNone: no surface
  std::vector<Vec3f> place, normal;
};

/// Texels around a chart continue its surface, so that viewers blend it with nothing else.
Texels place_texels(const TriangleMesh& mesh, const Atlas& atlas, const Chart& chart) {
  const size_t count = static_cast<size_t>(chart.width) * static_cast<size_t>(chart.height);
  Texels out{std::vector<uint32_t>(count, kNone), std::vector<Vec3f>(count), std::vector<Vec3f>(count)};
  for (const double margin : {0.0, 1.5}) {
    for (const uint32_t t : chart.triangles) {
      std::array<std::array<double, 2>, 3> corners;
      for (size_t i = 0; i < 3; ++i) corners[i] = {atlas.corners[t][i][0], atlas.corners[t][i][1]};
      const auto& v = mesh.triangles[t];
      const Vec3d a = mesh.vertices[v[0]].cast<double>(), b = mesh.vertices[v[1]].cast<double>(),
                  d = mesh.vertices[v[2]].cast<double>();
      const Vec3d face = cross(b - a, d - a);
      for_cells(corners, margin, [&](int x, int y, const std::array<double, 3>& w) {
        if (x < chart.x || y < chart.y || x >= chart.x + chart.width || y >= chart.y + chart.height) return;
        const size_t at =
            static_cast<size_t>(y - chart.y) * static_cast<size_t>(chart.width) + static_cast<size_t>(x - chart.x);
        if (out.triangle[at] != kNone) return;
        out.triangle[at] = t;
        out.place[at] = (a * w[0] + b * w[1] + d * w[2]).cast<float>();
        Vec3d n = face;
        if (!mesh.normals.empty()) {
          const Vec3d smooth = mesh.normals[v[0]].cast<double>() * w[0] + mesh.normals[v[1]].cast<double>() * w[1] +
                               mesh.normals[v[2]].cast<double>() * w[2];
          if (dot(smooth, face) > 0) n = smooth;
        }
        out.normal[at] = (n * (1 / std::max(norm(n), 1e-30))).cast<float>();
      });
    }
  }
  return out;
}

/// The colour of the splats around a place.
class SplatColor {
 public:
  explicit SplatColor(const GaussianModel& model) : tree_(places(model)), model_(model) {
    for (size_t i = 0; i < model.size(); ++i) {
      if (opacity_of(model, i) >= kLeastOpacity) rows_.push_back(static_cast<uint32_t>(i));
    }
  }
  Vec3f at(const Vec3f& place, std::vector<PointTree::Neighbour>& scratch) const {
    tree_.nearest(place, kNeighbours, scratch);
    if (scratch.empty()) return {0.5f, 0.5f, 0.5f};
    const double reach = std::max(1e-12, static_cast<double>(scratch[scratch.size() / 2].distance));
    double sum = 0;
    Vec3d color;
    for (const auto& near : scratch) {
      const double d = near.distance / reach, w = opacity_of(model_, rows_[near.index]) * std::exp(-0.5 * d * d);
      sum += w;
      color += base_color_of(model_, rows_[near.index]).cast<double>() * w;
    }
    color = color * (1 / sum);
    return {std::clamp(float(color.x), 0.f, 1.f), std::clamp(float(color.y), 0.f, 1.f),
            std::clamp(float(color.z), 0.f, 1.f)};
  }

 private:
  static constexpr float kLeastOpacity = 0.3f;  // fainter ones are haze before the surface
  static constexpr size_t kNeighbours = 8;

  static std::vector<Vec3f> places(const GaussianModel& model) {
    std::vector<Vec3f> out;
    for (size_t i = 0; i < model.size(); ++i) {
      if (opacity_of(model, i) >= kLeastOpacity)
        out.push_back({model.positions[3 * i], model.positions[3 * i + 1], model.positions[3 * i + 2]});
    }
    return out;
  }
  PointTree tree_;
  const GaussianModel& model_;
  std::vector<uint32_t> rows_;
};

/// Squares of the charts, row by row.
struct Patches {
  std::vector<size_t> first;  ///< of each chart
  std::vector<int> columns;   ///< of each chart
  size_t count = 0;
};

Patches patches_of(const Atlas& atlas, int size) {
  Patches out;
  for (const Chart& chart : atlas.charts) {
    out.first.push_back(out.count);
    out.columns.push_back((chart.width + size - 1) / size);
    out.count += static_cast<size_t>(out.columns.back()) * static_cast<size_t>((chart.height + size - 1) / size);
  }
  return out;
}

}  // namespace

Image<uint8_t> bake_texture(const TriangleMesh& mesh, const Atlas& atlas, const std::vector<uint8_t>& photographed,
                            const TexturePhotos& photos, const GaussianModel& splats, double extent, ThreadPool& pool,
                            const BakeSettings& settings, BakeReport* report) {
  const SplatColor splat_color(splats);
  const std::vector<PhotoWeight> weights = photo_weights(photos, extent, atlas.texel, settings, pool);
  const Patches patches = patches_of(atlas, settings.patch);
  const size_t width = static_cast<size_t>(atlas.width);
  Image<uint8_t> out(atlas.width, atlas.height, 3, 127);
  std::vector<size_t> from_photos(atlas.charts.size(), 0), all(atlas.charts.size(), 0);

  pool.parallel_for(atlas.charts.size(), 1, [&](size_t begin, size_t end, int) {
    std::vector<PointTree::Neighbour> scratch;
    for (size_t c = begin; c < end; ++c) {
      const Chart& chart = atlas.charts[c];
      const Texels texels = place_texels(mesh, atlas, chart);
      const int columns = patches.columns[c], rows = (chart.height + settings.patch - 1) / settings.patch;
      // The photos of each patch: those with the largest sums of weights.
      std::vector<std::vector<uint8_t>> chosen(static_cast<size_t>(columns) * static_cast<size_t>(rows),
                                               std::vector<uint8_t>(weights.size(), 0));
      for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
          std::vector<double> sum(weights.size(), 0);
          const int x1 = std::min(chart.width, (column + 1) * settings.patch),
                    y1 = std::min(chart.height, (row + 1) * settings.patch);
          for (int y = row * settings.patch; y < y1; ++y) {
            for (int x = column * settings.patch; x < x1; ++x) {
              const size_t at = static_cast<size_t>(y) * static_cast<size_t>(chart.width) + static_cast<size_t>(x);
              if (texels.triangle[at] == kNone || !photographed[texels.triangle[at]]) continue;
              for (size_t v = 0; v < weights.size(); ++v)
                sum[v] += weights[v].at(texels.place[at], texels.normal[at]).weight;
            }
          }
          auto& mine = chosen[static_cast<size_t>(row) * static_cast<size_t>(columns) + static_cast<size_t>(column)];
          for (int k = 0; k < settings.photos; ++k) {
            const auto best = std::max_element(sum.begin(), sum.end());
            if (best == sum.end() || !(*best > 0)) break;
            mine[static_cast<size_t>(best - sum.begin())] = 1;
            *best = 0;
          }
        }
      }
      for (int y = 0; y < chart.height; ++y) {
        for (int x = 0; x < chart.width; ++x) {
          const size_t at = static_cast<size_t>(y) * static_cast<size_t>(chart.width) + static_cast<size_t>(x);
          if (texels.triangle[at] == kNone) continue;
          ++all[c];
          Vec3d color;
          double sum = 0;
          // The four patches around, by their middles.
          const double px = std::clamp((x + 0.5) / settings.patch - 0.5, 0.0, columns - 1.0),
                       py = std::clamp((y + 0.5) / settings.patch - 0.5, 0.0, rows - 1.0);
          const int i0 = static_cast<int>(px), j0 = static_cast<int>(py), i1 = std::min(i0 + 1, columns - 1),
                    j1 = std::min(j0 + 1, rows - 1);
          const double fx = px - i0, fy = py - j0;
          for (size_t v = 0; photographed[texels.triangle[at]] && v < weights.size(); ++v) {
            const auto has = [&](int i, int j) {
              return static_cast<double>(chosen[static_cast<size_t>(j * columns + i)][v]);
            };
            const double share = (1 - fy) * ((1 - fx) * has(i0, j0) + fx * has(i1, j0)) +
                                 fy * ((1 - fx) * has(i0, j1) + fx * has(i1, j1));
            if (!(share > 0)) continue;
            const PhotoWeight::Look look = weights[v].at(texels.place[at], texels.normal[at]);
            if (!(look.weight > 0)) continue;
            const double w = share * std::pow(look.weight, settings.sharpening);
            color += weights[v].color(look.pixel) * w;
            sum += w;
          }
          from_photos[c] += sum > settings.splat_weight;
          // Photos fade into the splats where they see a place from the side only.
          if (sum < 100 * settings.splat_weight) {
            color += splat_color.at(texels.place[at], scratch).cast<double>() * settings.splat_weight;
            sum += settings.splat_weight;
          }
          const size_t pixel = static_cast<size_t>(chart.y + y) * width + static_cast<size_t>(chart.x + x);
          for (int k = 0; k < 3; ++k)
            out.data[3 * pixel + static_cast<size_t>(k)] =
                static_cast<uint8_t>(std::lround(255 * std::clamp(color[k] / sum, 0.0, 1.0)));
        }
      }
    }
  });
  if (report) {
    for (size_t c = 0; c < all.size(); ++c) {
      report->texels += all[c];
      report->from_photos += from_photos[c];
    }
  }
  return out;
}

}  // namespace aligngs
