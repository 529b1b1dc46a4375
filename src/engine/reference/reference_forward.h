// The specification of rendering: all Gaussians in one sorted list, one loop over pixels, no tiles. Slow and
// readable; in double it is the oracle of the tests.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "engine/engine.h"
#include "engine/formulas/blending.h"
#include "engine/formulas/color.h"
#include "engine/formulas/plane_depth.h"
#include "engine/formulas/semantic_loss.h"
#include "engine/maps.h"
#include "scene/triangle_mesh.h"

namespace aligngs::reference {

/// The Gaussians as one camera sees them.
template <class T>
struct Splats {
  ProjectionCamera<T> camera;
  std::vector<GaussianShape<T>> shapes;    ///< [N]
  std::vector<Projection<T>> projections;  ///< [N], status tells which count
  std::vector<Vec3<T>> colors;             ///< [N], defined where visible
  std::vector<uint32_t> order;             ///< visible rows, nearest first; equal depths in row order
  std::vector<uint32_t> non_finite;        ///< rows that were culled because a parameter or its image is not finite
};

template <class T>
GaussianShape<T> shape_of(const GaussianModelT<T>& model, size_t i) {
  const T *p = &model.positions[3 * i], *s = &model.log_scales[3 * i], *q = &model.rotations[4 * i];
  return {{p[0], p[1], p[2]}, {s[0], s[1], s[2]}, {q[0], q[1], q[2], q[3]}, model.opacity_logits[i]};
}

namespace detail {

/// False when a colour coefficient in use or a semantic logit of row i is NaN or infinite: max(0, NaN) and arg-max
/// would hide it.
template <class T>
bool appearance_finite(const GaussianModelT<T>& model, size_t i, int sh_degree) {
  for (int k = 0; k < 3 * sh_coefficient_count(sh_degree); ++k) {
    if (!is_finite(model.sh[3 * kShCoefficients * i + k])) return false;
  }
  for (int c = 0; c < model.semantic_channels; ++c) {
    if (!is_finite(model.semantics[i * model.semantic_channels + c])) return false;
  }
  return true;
}

}  // namespace detail

/// Projects, colours and sorts. A row with anything that is not finite is culled as a whole and reported.
template <class T>
Splats<T> make_splats(const GaussianModelT<T>& model, const Camera& camera, const RasterSettings& raster,
                      int sh_degree) {
  Splats<T> s;
  const size_t n = model.size();
  s.camera = make_projection_camera<T>(camera, raster);
  s.shapes.resize(n);
  s.projections.resize(n);
  s.colors.resize(n);
  for (size_t i = 0; i < n; ++i) {
    s.shapes[i] = shape_of(model, i);
    Projection<T>& p = s.projections[i];
    p = project(s.shapes[i], s.camera, raster);
    if (p.visible()) {
      const Vec3<T> direction = view_direction(s.shapes[i].position, s.camera.centre);
      s.colors[i] = sh_color(sh_degree, direction, &model.sh[3 * kShCoefficients * i]);
      if (!detail::appearance_finite(model, i, sh_degree) || !is_finite(s.colors[i])) {
        p.status = ProjectionStatus::kNonFinite;
      } else if (raster.dropout.drops(i)) {
        p.status = ProjectionStatus::kDropped;
      }
    }
    if (p.status == ProjectionStatus::kNonFinite) s.non_finite.push_back(static_cast<uint32_t>(i));
    if (p.visible()) s.order.push_back(static_cast<uint32_t>(i));
  }
  std::stable_sort(s.order.begin(), s.order.end(),
                   [&](uint32_t a, uint32_t b) { return s.projections[a].z < s.projections[b].z; });
  return s;
}

/// One Gaussian blended into one pixel.
template <class T>
struct Contribution {
  uint32_t row = 0;
  AlphaSample<T> sample;
  T transmittance{};  ///< before this Gaussian
  T weight{};         ///< alpha * transmittance
};

/// Everything blended into pixel (x, y), front to back. `final_transmittance` is what the background shows through.
template <class T>
void blend_pixel(const Splats<T>& s, int x, int y, const RasterSettings& raster, std::vector<Contribution<T>>& out,
                 T& final_transmittance) {
  out.clear();
  T transmittance = T(1);
  for (const uint32_t row : s.order) {
    const Projection<T>& p = s.projections[row];
    if (x < p.pixels.x0 || x >= p.pixels.x1 || y < p.pixels.y0 || y >= p.pixels.y1) continue;
    const AlphaSample<T> sample = alpha_at(p.mean, p.conic, p.opacity, x + T(0.5), y + T(0.5), raster);
    if (!(sample.alpha > T(0))) continue;
    Contribution<T> c{row, sample, transmittance, T(0)};
    if (!blend_step(sample.alpha, T(raster.transmittance_min), transmittance, c.weight)) break;
    out.push_back(c);
  }
  final_transmittance = transmittance;
}

/// The maps of engine/maps.h.
template <class T>
RenderMaps<T> render_maps(const Splats<T>& s, const RasterSettings& raster) {
  RenderMaps<T> m;
  m.width = s.camera.width;
  m.height = s.camera.height;
  const size_t n = m.pixels();
  m.color.assign(3 * n, T(0));
  m.normal.assign(3 * n, T(0));
  m.alpha.assign(n, T(0));
  m.distance.assign(n, T(0));
  m.expected.assign(n, T(0));
  m.median.assign(n, T(0));
  std::vector<Contribution<T>> list;
  for (int y = 0; y < m.height; ++y) {
    for (int x = 0; x < m.width; ++x) {
      const size_t u = size_t(y) * m.width + x;
      const Vec3<T> ray = s.camera.ray(x, y);
      T left = T(1);
      blend_pixel(s, x, y, raster, list, left);
      for (const Contribution<T>& c : list) {
        const Projection<T>& p = s.projections[c.row];
        const T z = intersection_depth(p, ray);
        for (int k = 0; k < 3; ++k) {
          m.color[k * n + u] += c.weight * s.colors[c.row][k];
          m.normal[k * n + u] += c.weight * p.normal[k];
        }
        m.alpha[u] += c.weight;
        m.distance[u] += c.weight * p.distance;
        m.expected[u] += c.weight * z;
        const T after = c.transmittance * (T(1) - c.sample.alpha);
        if (m.median[u] == T(0) && after < T(kMedianTransmittance)) m.median[u] = z;
      }
      for (int k = 0; k < 3; ++k) m.color[k * n + u] += left * T(raster.background[k]);
    }
  }
  return m;
}

/// The blended values per Gaussian for the semantics, [N][C]: the logits themselves, or softmax of each row.
template <class T>
std::vector<T> semantic_features(const GaussianModelT<T>& model, SemanticBlend blend) {
  std::vector<T> x = model.semantics;
  const int channels = model.semantic_channels;
  if (blend == SemanticBlend::kProbabilities && channels > 0) {
    for (size_t i = 0; i < model.size(); ++i) softmax(&x[i * channels], channels, &x[i * channels]);
  }
  return x;
}

/// Blended semantics, [H * W][C]: P = sum w s, or B = sum w pi without the remainder (1 - A) / C.
template <class T>
std::vector<T> render_semantics(const Splats<T>& s, const std::vector<T>& features, int channels,
                                const RasterSettings& raster) {
  std::vector<T> out(size_t(s.camera.width) * s.camera.height * channels, T(0));
  std::vector<Contribution<T>> list;
  for (int y = 0; y < s.camera.height; ++y) {
    for (int x = 0; x < s.camera.width; ++x) {
      T left = T(1);
      blend_pixel(s, x, y, raster, list, left);
      T* pixel = &out[(size_t(y) * s.camera.width + x) * channels];
      for (const Contribution<T>& c : list) {
        for (int k = 0; k < channels; ++k) pixel[k] += c.weight * features[size_t(c.row) * channels + k];
      }
    }
  }
  return out;
}

/// Engine::render: unit normals, the three depths, labels with their probability.
template <class T>
Rendering render(const GaussianModelT<T>& model, const Camera& camera, const RenderOptions& options) {
  const Splats<T> s = make_splats(model, camera, options.raster, model.sh_degree);
  const RenderMaps<T> m = render_maps(s, options.raster);
  const int w = m.width, h = m.height;
  const size_t n = m.pixels();
  Rendering r;
  r.color = ImageF(w, h, 3);
  r.alpha = ImageF(w, h, 1);
  for (size_t u = 0; u < n; ++u) {
    for (int k = 0; k < 3; ++k) r.color.data[3 * u + k] = static_cast<float>(m.color[k * n + u]);
    r.alpha.data[u] = static_cast<float>(m.alpha[u]);
  }
  if (options.geometry) {
    r.normal = ImageF(w, h, 3);
    r.depth_plane = r.depth_median = r.depth_expected = ImageF(w, h, 1);
    for (int y = 0; y < h; ++y) {
      for (int x = 0; x < w; ++x) {
        const size_t u = size_t(y) * w + x;
        const Vec3<T> sum{m.normal[u], m.normal[n + u], m.normal[2 * n + u]};
        const Vec3<T> unit = normalized(sum);
        for (int k = 0; k < 3; ++k) r.normal.data[3 * u + k] = static_cast<float>(unit[k]);
        const T z = plane_depth(sum, m.distance[u], m.alpha[u], s.camera.ray(x, y)).z;
        const bool valid = plane_depth_valid(z, m.alpha[u], m.expected[u], T(kPlaneAlphaLoss));
        r.depth_plane.data[u] = valid ? static_cast<float>(z) : 0.0f;
        r.depth_median.data[u] = static_cast<float>(m.median[u]);
        r.depth_expected.data[u] = m.alpha[u] > T(0) ? static_cast<float>(m.expected[u] / m.alpha[u]) : 0.0f;
      }
    }
  }
  const int channels = model.semantic_channels;
  if (options.labels && channels > 0) {
    r.label = Image<uint16_t>(w, h, 1, kNoLabel);
    r.label_probability = ImageF(w, h, 1);
    const bool probabilities = options.semantic_blend == SemanticBlend::kProbabilities;
    const std::vector<T> features = semantic_features(model, options.semantic_blend);
    std::vector<T> pixels = render_semantics(s, features, channels, options.raster);
    for (size_t u = 0; u < n; ++u) {
      T* q = &pixels[u * channels];
      if (probabilities) {
        for (int c = 0; c < channels; ++c) q[c] += (T(1) - m.alpha[u]) / T(channels);
      } else {
        softmax(q, channels, q);
      }
      const int best = arg_max(q, channels);
      r.label_probability.data[u] = static_cast<float>(q[best]);
      if (m.alpha[u] >= T(0.5)) r.label.data[u] = static_cast<uint16_t>(best);
    }
  }
  return r;
}

}  // namespace aligngs::reference
