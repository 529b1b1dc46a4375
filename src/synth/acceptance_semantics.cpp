#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "scene/triangle_mesh.h"
#include "synth/acceptance_measures.h"

namespace aligngs {
namespace {

constexpr int kEdgeBand = 3;       // pixels around a true label edge
constexpr int kSampleStep = 5;     // wrong pixels looked up in other views: every n-th
constexpr double kPresent = 1e-3;  // share of the pixels from which a class counts as present

/// Pixel of `view` that shows the world point, or -1 when the point is outside or hidden. The view's own depth there
/// must agree within 2 % + 2 cm.
long pixel_of(const RenderedView& view, const Vec3d& point) {
  const Vec3d q = view.camera.world_to_camera * point;
  if (q.z <= 0.05) return -1;
  const Vec2d p = view.camera.project(q);
  if (!view.camera.contains(p)) return -1;
  const int x = static_cast<int>(p.x), y = static_cast<int>(p.y);
  const double z = view.depth.at(x, y);
  if (!(z > 0) || std::fabs(z - q.z) > 0.02 * q.z + 0.02) return -1;
  return static_cast<long>(y) * view.camera.width + x;
}

bool near_edge(const Image<uint16_t>& labels, int x, int y) {
  const uint16_t own = labels.at(x, y);
  for (int v = std::max(0, y - kEdgeBand); v <= std::min(labels.height - 1, y + kEdgeBand); ++v) {
    for (int u = std::max(0, x - kEdgeBand); u <= std::min(labels.width - 1, x + kEdgeBand); ++u) {
      if ((u - x) * (u - x) + (v - y) * (v - y) <= kEdgeBand * kEdgeBand && labels.at(u, v) != own) return true;
    }
  }
  return false;
}

}  // namespace

SemanticFigures measure_semantics(const SynthScene& scene, ThreadPool& pool) {
  const size_t n = scene.views.size();
  std::vector<Image<uint16_t>> said(n);
  struct Tally {
    double correct = 0, total = 0, edge_correct = 0, edge_total = 0, wrong = 0, persistent = 0;
  };
  std::vector<Tally> tallies(n);
  pool.parallel_for(n, 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      const Image<uint16_t>& truth = scene.views[i].truth.labels;
      said[i] = semantic_labels(scene.views[i].scores, truth.width, truth.height);
      Tally& t = tallies[i];
      for (int y = 0; y < truth.height; ++y) {
        for (int x = 0; x < truth.width; ++x) {
          if (truth.at(x, y) == kNoLabel) continue;
          const bool right = said[i].at(x, y) == truth.at(x, y);
          t.correct += right;
          t.total += 1;
          if (!near_edge(truth, x, y)) continue;
          t.edge_correct += right;
          t.edge_total += 1;
        }
      }
    }
  });
  // For a wrong pixel: is the point wrong in more than half of all views that see it?
  pool.parallel_for(n, 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      const RenderedView& view = scene.views[i].truth;
      for (size_t p = i % kSampleStep; p < view.labels.data.size(); p += kSampleStep) {
        const uint16_t label = view.labels.data[p];
        if (label == kNoLabel || said[i].data[p] == label) continue;
        const int x = static_cast<int>(p) % view.camera.width, y = static_cast<int>(p) / view.camera.width;
        const Vec3d point = view.camera.unproject(x + 0.5, y + 0.5, view.depth.at(x, y));
        int seen = 1, wrong = 1;
        for (size_t j = 0; j < n; ++j) {
          if (j == i) continue;
          const long q = pixel_of(scene.views[j].truth, point);
          // Another object at that pixel means that rounding crossed an outline: it says nothing of this point.
          if (q < 0 || scene.views[j].truth.labels.data[static_cast<size_t>(q)] != label) continue;
          ++seen;
          wrong += said[j].data[static_cast<size_t>(q)] != label;
        }
        if (seen < 2) continue;
        tallies[i].wrong += 1;
        tallies[i].persistent += 2 * wrong > seen;
      }
    }
  });
  Tally sum;
  std::map<uint16_t, std::array<double, 3>> classes;  // intersection, truth, said
  for (size_t i = 0; i < n; ++i) {
    const Tally& t = tallies[i];
    sum.correct += t.correct, sum.total += t.total, sum.edge_correct += t.edge_correct, sum.edge_total += t.edge_total;
    sum.wrong += t.wrong, sum.persistent += t.persistent;
    const Image<uint16_t>& truth = scene.views[i].truth.labels;
    for (size_t p = 0; p < truth.data.size(); ++p) {
      if (truth.data[p] == kNoLabel) continue;
      classes[truth.data[p]][1] += 1;
      classes[said[i].data[p]][2] += 1;
      if (truth.data[p] == said[i].data[p]) classes[truth.data[p]][0] += 1;
    }
  }
  SemanticFigures f;
  const auto share = [](double a, double b) { return b > 0 ? a / b : 0; };
  f.accuracy = share(sum.correct, sum.total);
  f.edge_accuracy = share(sum.edge_correct, sum.edge_total);
  f.persistent_share = share(sum.persistent, sum.wrong);
  double present = 0;
  for (const auto& [label, c] : classes) {
    if (c[1] < kPresent * sum.total || c[1] == 0) continue;
    f.miou += c[0] / (c[1] + c[2] - c[0]);
    present += 1;
  }
  f.miou = share(f.miou, present);
  return f;
}

double measure_panoptic(const SynthScene& scene) {
  std::vector<SegmentMap> truth, said;
  for (const SynthView& view : scene.views) {
    truth.push_back(exact_segments(view.truth));
    said.push_back(view.segments);
  }
  return panoptic_quality(truth, said);
}

CoverageFigures measure_coverage(const SynthScene& scene, ThreadPool& pool) {
  const size_t n = scene.views.size();
  std::vector<double> share(n, 0);
  pool.parallel_for(n, 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      const RenderedView& view = scene.views[i].truth;
      double total = 0, seen = 0;
      for (size_t p = 0; p < view.depth.data.size(); p += 3) {
        if (!(view.depth.data[p] > 0)) continue;
        const int x = static_cast<int>(p) % view.camera.width, y = static_cast<int>(p) / view.camera.width;
        const Vec3d point = view.camera.unproject(x + 0.5, y + 0.5, view.depth.data[p]);
        total += 1;
        for (const int j : scene.train) {
          if (static_cast<size_t>(j) == i || pixel_of(scene.views[j].truth, point) < 0) continue;
          seen += 1;
          break;
        }
      }
      share[i] = total > 0 ? seen / total : 0;
    }
  });
  CoverageFigures f;
  for (const int i : scene.test) f.test_seen = std::min(f.test_seen, share[i]);
  for (const int i : scene.train) f.seen_twice += share[i] / static_cast<double>(scene.train.size());
  return f;
}

}  // namespace aligngs
