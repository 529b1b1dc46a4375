#include "refine/bundle_points.h"

#include <algorithm>

#include "core/always_inline.h"
#include "core/target_clones.h"

namespace aligngs {
namespace {

constexpr double kLeastDiagonal = 1e-6;  // so that what hardly counts is damped, too
constexpr double kMostDiagonal = 1e32;

/// Nothing (zeros) if it is singular.
ALIGNGS_ALWAYS_INLINE void invert(const Symmetric3& a, Symmetric3& out) {
  const double* const m = a.m;
  const double xx = m[3] * m[5] - m[4] * m[4], xy = m[2] * m[4] - m[1] * m[5], xz = m[1] * m[4] - m[2] * m[3];
  const double determinant = m[0] * xx + m[1] * xy + m[2] * xz;
  const double factor = determinant > 0 ? 1 / determinant : 0;
  out = {{factor * xx, factor * xy, factor * xz, factor * (m[0] * m[5] - m[2] * m[2]),
          factor * (m[1] * m[2] - m[0] * m[4]), factor * (m[0] * m[3] - m[1] * m[1])}};
}

ALIGNGS_ALWAYS_INLINE Vec3d product(const Symmetric3& a, const Vec3d& v) {
  return {a.m[0] * v.x + a.m[1] * v.y + a.m[2] * v.z, a.m[1] * v.x + a.m[3] * v.y + a.m[4] * v.z,
          a.m[2] * v.x + a.m[4] * v.y + a.m[5] * v.z};
}

/// Adds a b' to the rows of a block.
ALIGNGS_ALWAYS_INLINE void add_outer(const DoubleLanes& a, const DoubleLanes& b, Lanes* rows) {
  for (int i = 0; i < kLanes; ++i) add(a[i] * b, rows[i]);
}

/// A term's part of the sums of its view, its link, and its part of its point's block and gradient.
ALIGNGS_ALWAYS_INLINE void add_term(const TermRows& rows, const Lanes& unknown, size_t view, ViewSums& sums,
                                    TermLink& link, Symmetric3& block, Vec3d& gradient) {
  DoubleLanes solved_for, axes[3]{};
  load(unknown, solved_for);
  for (int r = 0; r < rows.rows; ++r) {
    DoubleLanes by_view;
    load(rows.by_view[r], by_view);
    by_view *= solved_for;
    const DoubleLanes weighted = rows.weight[r] * by_view;
    const Vec3d d = rows.by_point[r], w = rows.weight[r] * d;
    add_outer(weighted, by_view, &sums.blocks[block_of(view, view)]);
    add(weighted * by_view, sums.diagonal[view]);
    add(rows.residual[r] * weighted, sums.gradient[view]);
    for (int k = 0; k < 3; ++k) axes[k] += d[k] * weighted;
    const double products[6] = {w.x * d.x, w.x * d.y, w.x * d.z, w.y * d.y, w.y * d.z, w.z * d.z};
    for (int k = 0; k < 6; ++k) block.m[k] += products[k];
    gradient += rows.residual[r] * w;
  }
  for (int k = 0; k < 3; ++k) store(axes[k], link.by_axis[k]);
}

/// Takes what the views of a point have in common through it out of their blocks. `solved`: scratch.
ALIGNGS_ALWAYS_INLINE void take_out(const BundleTerm* terms, const TermLink* links, size_t count,
                                    const PointEquations& point, std::vector<TermLink>& solved, ViewSums& sums) {
  const double* const m = point.inverse.m;
  const Vec3d& g = point.gradient;
  solved.resize(count);
  for (size_t k = 0; k < count; ++k) {
    DoubleLanes w[3];
    for (int axis = 0; axis < 3; ++axis) load(links[k].by_axis[axis], w[axis]);
    const DoubleLanes x = m[0] * w[0] + m[1] * w[1] + m[2] * w[2], y = m[1] * w[0] + m[3] * w[1] + m[4] * w[2],
                      z = m[2] * w[0] + m[4] * w[1] + m[5] * w[2];
    store(x, solved[k].by_axis[0]);
    store(y, solved[k].by_axis[1]);
    store(z, solved[k].by_axis[2]);
    add(-(g.x * x + g.y * y + g.z * z), sums.reduced[static_cast<size_t>(terms[k].view)]);
  }
  for (size_t l = 0; l < count; ++l) {
    const size_t earlier = static_cast<size_t>(terms[l].view);
    DoubleLanes w[3];
    for (int axis = 0; axis < 3; ++axis) load(links[l].by_axis[axis], w[axis]);
    for (size_t k = 0; k < count; ++k) {
      const size_t later = static_cast<size_t>(terms[k].view);
      if (later < earlier) continue;
      const Lanes* const y = solved[k].by_axis;
      Lanes* const rows = &sums.blocks[block_of(later, earlier)];
      for (int i = 0; i < kLanes; ++i) add(-(y[0][i] * w[0] + y[1][i] * w[1] + y[2][i] * w[2]), rows[i]);
    }
  }
}

}  // namespace

double bundle_damping(double diagonal, double radius) {
  return std::clamp(diagonal, kLeastDiagonal, kMostDiagonal) / radius;
}

void ViewSums::add(const ViewSums& other) {
  const auto add_lanes = [](const std::vector<Lanes>& from, std::vector<Lanes>& to) {
    for (size_t i = 0; i < to.size(); ++i) {
      for (int lane = 0; lane < kLanes; ++lane) to[i][lane] += from[i][lane];
    }
  };
  add_lanes(other.blocks, blocks);
  add_lanes(other.gradient, gradient);
  add_lanes(other.reduced, reduced);
  add_lanes(other.diagonal, diagonal);
  in_front = in_front && other.in_front;
}

ALIGNGS_TARGET_CLONES
void eliminate_points(const PointShare& share, ViewSums& sums, TermLink* links, PointEquations* points) {
  std::vector<TermLink> solved;
  for (size_t p = share.begin; p < share.end; ++p) {
    const size_t begin = share.first[p], end = share.first[p + 1];
    if (begin == end) continue;
    Symmetric3 block;
    Vec3d gradient{};
    for (size_t t = begin; t < end; ++t) {
      const BundleTerm& term = share.terms[t];
      const size_t view = static_cast<size_t>(term.view);
      TermRows rows;
      if (!linearise(term, share.at.cameras[view], share.at.points[p], share.at.log_scales[view], rows)) {
        sums.in_front = false;
        return;
      }
      add_term(rows, share.unknown[view], view, sums, links[t], block, gradient);
    }
    if (share.fixed_points) continue;
    PointEquations& point = points[p];
    point.gradient = gradient;
    point.damping = {bundle_damping(block.m[0], share.radius), bundle_damping(block.m[3], share.radius),
                     bundle_damping(block.m[5], share.radius)};
    block.m[0] += point.damping.x;
    block.m[3] += point.damping.y;
    block.m[5] += point.damping.z;
    invert(block, point.inverse);
    take_out(&share.terms[begin], &links[begin], end - begin, point, solved, sums);
  }
}

double point_steps(const PointShare& share, const std::vector<Lanes>& views, const TermLink* links,
                   const PointEquations* points, Vec3d* steps) {
  double decrease = 0;
  for (size_t p = share.begin; p < share.end; ++p) {
    Vec3d right = points[p].gradient;
    for (size_t t = share.first[p]; t < share.first[p + 1]; ++t) {
      const Lanes& view = views[static_cast<size_t>(share.terms[t].view)];
      for (int k = 0; k < 3; ++k) {
        for (int lane = 0; lane < kLanes; ++lane) right[k] += links[t].by_axis[k][lane] * view[lane];
      }
    }
    const Vec3d step = -product(points[p].inverse, right), d = points[p].damping;
    steps[p] = step;
    decrease +=
        0.5 * (d.x * step.x * step.x + d.y * step.y * step.y + d.z * step.z * step.z - dot(points[p].gradient, step));
  }
  return decrease;
}

}  // namespace aligngs
