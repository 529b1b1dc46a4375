#include "refine/bundle_terms.h"

#include <cmath>
#include <limits>

#include "core/rotation_vector.h"

namespace aligngs {
namespace {

/// In the deviations of the term; `p` is in the camera's frame.
struct TermErrors {
  double x, y;  ///< pixels, as they are
  double place[2];
  double depth;
};

TermErrors errors_of(const BundleTerm& term, const Camera& camera, const Vec3d& p, double log_scale) {
  const Vec2d at = camera.project(p);
  TermErrors e{at.x - term.pixel.x, at.y - term.pixel.y, {}, 0};
  e.place[0] = term.whitening[0] * e.x;
  e.place[1] = term.whitening[1] * e.x + term.whitening[2] * e.y;
  if (term.depth_sigma > 0) e.depth = (std::log(p.z) - term.log_depth - log_scale) / term.depth_sigma;
  return e;
}

/// A row from its derivative by the point in the camera's frame.
void add_row(TermRows& out, double residual, const Camera& camera, const Vec3d& p, const Vec3d& d, double by_focal,
             double by_scale) {
  const Vec3d turn = cross(p, d), point = transpose(camera.world_to_camera.rotation) * d;
  out.residual[out.rows] = residual;
  out.by_view[out.rows] = {{turn.x, turn.y, turn.z, -point.x, -point.y, -point.z, by_focal, by_scale}};
  out.by_point[out.rows] = point;
  ++out.rows;
}

}  // namespace

Camera moved_camera(const Camera& camera, const Lanes& step) {
  Camera out = camera;
  const Vec3d centre = camera.centre() + Vec3d{step[kShiftLane], step[kShiftLane + 1], step[kShiftLane + 2]};
  Rigidd& pose = out.world_to_camera;
  pose.rotation = rotation_of({step[kTurnLane], step[kTurnLane + 1], step[kTurnLane + 2]}) * pose.rotation;
  pose.translation = -(pose.rotation * centre);
  out.fx *= std::exp(step[kFocalLane]);
  out.fy *= std::exp(step[kFocalLane]);
  return out;
}

double term_cost(const BundleTerm& term, const BundleState& state) {
  const size_t view = static_cast<size_t>(term.view);
  const Camera& camera = state.cameras[view];
  const Vec3d p = camera.world_to_camera * state.points[static_cast<size_t>(term.point)];
  if (!(p.z >= kNearestPoint)) return std::numeric_limits<double>::infinity();
  const TermErrors e = errors_of(term, camera, p, state.log_scales[view]);
  return 0.5 * std::log((1 + e.place[0] * e.place[0] + e.place[1] * e.place[1]) * (1 + e.depth * e.depth));
}

bool linearise(const BundleTerm& term, const Camera& camera, const Vec3d& point, double log_scale, TermRows& out) {
  const Vec3d p = camera.world_to_camera * point;
  if (!(p.z >= kNearestPoint)) return false;
  const TermErrors e = errors_of(term, camera, p, log_scale);
  const double x = p.x / p.z, y = p.y / p.z, u = camera.fx / p.z, v = camera.fy / p.z;
  const Vec3d dx{u, 0, -u * x}, dy{0, v, -v * y};
  const double focal_x = camera.fx * x, focal_y = camera.fy * y;
  out.rows = 0;
  add_row(out, e.place[0], camera, p, term.whitening[0] * dx, term.whitening[0] * focal_x, 0);
  add_row(out, e.place[1], camera, p, term.whitening[1] * dx + term.whitening[2] * dy,
          term.whitening[1] * focal_x + term.whitening[2] * focal_y, 0);
  out.weight[0] = out.weight[1] = 1 / (1 + e.place[0] * e.place[0] + e.place[1] * e.place[1]);
  if (term.depth_sigma > 0) {
    out.weight[2] = 1 / (1 + e.depth * e.depth);
    add_row(out, e.depth, camera, p, {0, 0, 1 / (p.z * term.depth_sigma)}, 0, -1 / term.depth_sigma);
  }
  return true;
}

}  // namespace aligngs
