#include "synth/teacher_regions.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "scene/triangle_mesh.h"
#include "synth/class_confusions.h"
#include "synth/noise.h"

namespace aligngs {
namespace {

constexpr double kOutlineLength = 20;  // correlation length of outline errors, image pixels
constexpr double kMaskSoftness = 2;    // m_q = sigmoid(signed distance / 2 px), image pixels
constexpr int kStride = 4;             // of the network's mask features, image pixels
constexpr double kReach = 14;          // masks are below 0.1 % this far outside, image pixels

/// One-dimensional squared distance transform (Felzenszwalb and Huttenlocher 2012), in place with a stride.
void distance_pass(float* f, int n, int stride, std::vector<float>& out, std::vector<int>& v, std::vector<float>& z) {
  out.resize(static_cast<size_t>(n));
  v.resize(static_cast<size_t>(n));
  z.resize(static_cast<size_t>(n) + 1);
  const auto at = [&](int i) { return f[static_cast<size_t>(i) * stride]; };
  int k = 0;
  v[0] = 0;
  z[0] = -1e20f;
  z[1] = 1e20f;
  for (int q = 1; q < n; ++q) {
    float s = 0;
    while (true) {
      const int p = v[k];
      s = ((at(q) + static_cast<float>(q * q)) - (at(p) + static_cast<float>(p * p))) / static_cast<float>(2 * (q - p));
      if (s > z[k]) break;
      --k;
    }
    v[++k] = q;
    z[k] = s;
    z[k + 1] = 1e20f;
  }
  k = 0;
  for (int q = 0; q < n; ++q) {
    while (z[k + 1] < static_cast<float>(q)) ++k;
    out[q] = static_cast<float>((q - v[k]) * (q - v[k])) + at(v[k]);
  }
  for (int q = 0; q < n; ++q) f[static_cast<size_t>(q) * stride] = out[q];
}

void squared_distance(ImageF& f) {
  std::vector<float> out, z;
  std::vector<int> v;
  for (int y = 0; y < f.height; ++y) distance_pass(&f.at(0, y), f.width, 1, out, v, z);
  for (int x = 0; x < f.width; ++x) distance_pass(&f.at(x, 0), f.height, f.width, out, v, z);
}

}  // namespace

std::vector<QueryRegion> query_regions(const RenderedView& view) {
  const int w = view.labels.width, h = view.labels.height;
  std::map<int, QueryRegion> found;
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      const uint16_t label = view.labels.at(x, y);
      if (label == kNoLabel) continue;
      const int key = is_stuff(label) ? -1 - static_cast<int>(label) : static_cast<int>(view.instances.at(x, y));
      QueryRegion& r = found[key];
      if (r.mask.empty()) r.mask.assign(view.labels.pixels(), 0);
      r.label = label;
      r.key = key;
      r.mask[static_cast<size_t>(y) * w + x] = 1;
      r.x0 = std::min(r.x0, x), r.x1 = std::max(r.x1, x), r.y0 = std::min(r.y0, y), r.y1 = std::max(r.y1, y);
      ++r.pixels;
      r.depth_sum += view.depth.at(x, y);
      r.border += x == 0 || y == 0 || x == w - 1 || y == h - 1 ? 1 : 0;
    }
  }
  std::vector<QueryRegion> out;
  for (auto& [key, region] : found) out.push_back(std::move(region));
  return out;
}

SoftMask soft_mask(const QueryRegion& region, int w, int h, int out_w, int out_h, double outline_rms, Random& random) {
  // The outline is displaced by a smooth random field ...
  const int columns = std::max(1, static_cast<int>(w / kOutlineLength)),
            rows = std::max(1, static_cast<int>(h / kOutlineLength));
  const double rms = outline_rms / std::sqrt(2.0);  // of each component
  const ImageF dx = smooth_random_map(w, h, columns, rows, rms, random);
  const ImageF dy = smooth_random_map(w, h, columns, rows, rms, random);
  // ... and drawn on the network's coarse grid.
  const int cw = (w + kStride - 1) / kStride, ch = (h + kStride - 1) / kStride;
  ImageF coarse(cw, ch, 1);
  for (int j = 0; j < ch; ++j) {
    for (int i = 0; i < cw; ++i) {
      float sum = 0;
      for (int k = 0; k < 4; ++k) {
        const int x = std::min(w - 1, i * kStride + 1 + 2 * (k % 2)),
                  y = std::min(h - 1, j * kStride + 1 + 2 * (k / 2));
        const int sx = std::clamp(static_cast<int>(std::lround(x + dx.at(x, y))), 0, w - 1);
        const int sy = std::clamp(static_cast<int>(std::lround(y + dy.at(x, y))), 0, h - 1);
        sum += region.mask[static_cast<size_t>(sy) * w + sx];
      }
      coarse.at(i, j) = sum / 4;
    }
  }
  const double scale = static_cast<double>(w) / out_w, margin = kReach + 3 * outline_rms;
  SoftMask m;
  m.x0 = std::max(0, static_cast<int>((region.x0 - margin) / scale));
  m.y0 = std::max(0, static_cast<int>((region.y0 - margin) / scale));
  const int x1 = std::min(out_w, static_cast<int>((region.x1 + margin) / scale) + 2);
  const int y1 = std::min(out_h, static_cast<int>((region.y1 + margin) / scale) + 2);
  ImageF inside(std::max(1, x1 - m.x0), std::max(1, y1 - m.y0), 1), outside = inside;
  ImageF level = inside;
  for (int y = 0; y < inside.height; ++y) {
    for (int x = 0; x < inside.width; ++x) {
      const double u = std::clamp((m.x0 + x + 0.5) * scale / kStride - 0.5, 0.0, cw - 1.0);
      const double v = std::clamp((m.y0 + y + 0.5) * scale / kStride - 0.5, 0.0, ch - 1.0);
      const int i = std::min(static_cast<int>(u), std::max(0, cw - 2)),
                j = std::min(static_cast<int>(v), std::max(0, ch - 2));
      const int i1 = std::min(i + 1, cw - 1), j1 = std::min(j + 1, ch - 1);
      const float a = static_cast<float>(u - i), b = static_cast<float>(v - j);
      const float value = (coarse.at(i, j) * (1 - a) + coarse.at(i1, j) * a) * (1 - b) +
                          (coarse.at(i, j1) * (1 - a) + coarse.at(i1, j1) * a) * b;
      level.at(x, y) = value;
      constexpr float kFar = 1e6f;
      inside.at(x, y) = value > 0.5f ? kFar : 0.0f;
      outside.at(x, y) = value > 0.5f ? 0.0f : kFar;
    }
  }
  squared_distance(inside);
  squared_distance(outside);
  m.value = ImageF(inside.width, inside.height, 1);
  for (size_t k = 0; k < m.value.data.size(); ++k) {
    double signed_distance = inside.data[k] > 0 ? std::sqrt(inside.data[k]) - 0.5 : -(std::sqrt(outside.data[k]) - 0.5);
    signed_distance = std::clamp(signed_distance + (level.data[k] - 0.5), -60.0, 60.0) * scale;
    m.value.data[k] = static_cast<float>(1 / (1 + std::exp(-signed_distance / kMaskSoftness)));
  }
  return m;
}

}  // namespace aligngs
