#include "mesh/chart_atlas.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"
#include "mesh/charts.h"

namespace aligngs {
namespace {

constexpr double kStep = 1.04;       // by which texels grow until the charts fit
constexpr int kSteps = 400;          // a factor of some millions
constexpr double kRoomToPack = 1.1;  // area of the picture beside that of the rectangles

/// Texels of a length: its ends lie in the middle of texels.
int texels(double length, double texel, int gutter) {
  return static_cast<int>(std::ceil(length / texel)) + 1 + 2 * gutter;
}

/// Rows of rectangles, the highest first. The height that they need, or 0 when one is too wide.
int pack(std::vector<Chart>& charts, const std::vector<uint32_t>& order, int width) {
  int x = 0, y = 0, row = 0;
  for (const uint32_t i : order) {
    Chart& chart = charts[i];
    if (chart.width > width) return 0;
    if (x + chart.width > width) {
      x = 0;
      y += row;
      row = 0;
    }
    chart.x = x;
    chart.y = y;
    x += chart.width;
    row = std::max(row, chart.height);
  }
  return y + row;
}

}  // namespace

Atlas make_atlas(const TriangleMesh& mesh, const std::vector<uint32_t>& part, const AtlasSettings& settings) {
  if (!(settings.texel > 0)) throw_usage("an atlas needs a size of texels");
  Atlas atlas;
  std::vector<FlatChart> flat = flat_charts(mesh, part, settings.texel, settings);
  std::vector<uint32_t> order(flat.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return flat[a].height > flat[b].height; });
  atlas.charts.resize(flat.size());
  atlas.texel = settings.texel;
  for (int step = 0; atlas.height == 0; ++step, atlas.texel *= kStep) {
    if (step == kSteps)
      throw Error({ErrorKind::kFailed,
                   "the charts of the mesh fit in no texture of " + std::to_string(settings.size) + " texels",
                   {},
                   "--texture-size",
                   "simplify the mesh more, or ask for a larger texture"});
    double area = 0;
    int widest = 1;
    for (size_t i = 0; i < flat.size(); ++i) {
      Chart& chart = atlas.charts[i];
      chart.width = texels(flat[i].width, atlas.texel, settings.gutter);
      chart.height = texels(flat[i].height, atlas.texel, settings.gutter);
      area += static_cast<double>(chart.width) * chart.height;
      widest = std::max(widest, chart.width);
    }
    if (area > static_cast<double>(settings.size) * settings.size) continue;
    const int wanted = std::max(widest, static_cast<int>(std::sqrt(kRoomToPack * area)));
    atlas.width = std::min(settings.size, (wanted + 63) / 64 * 64);
    const int height = pack(atlas.charts, order, atlas.width);
    if (height > 0 && height <= settings.size) {
      atlas.height = (height + 3) / 4 * 4;
      break;
    }
  }
  atlas.corners.resize(mesh.triangles.size());
  atlas.chart_of.resize(mesh.triangles.size());
  for (uint32_t i = 0; i < flat.size(); ++i) {
    Chart& chart = atlas.charts[i];
    chart.triangles = std::move(flat[i].triangles);
    chart.normal = flat[i].normal;
    for (size_t k = 0; k < chart.triangles.size(); ++k) {
      const uint32_t t = chart.triangles[k];
      atlas.chart_of[t] = i;
      for (size_t c = 0; c < 3; ++c) {
        atlas.corners[t][c] = {
            static_cast<float>(chart.x + settings.gutter + 0.5 + flat[i].corners[k][c][0] / atlas.texel),
            static_cast<float>(chart.y + settings.gutter + 0.5 + flat[i].corners[k][c][1] / atlas.texel)};
      }
    }
  }
  return atlas;
}

}  // namespace aligngs
