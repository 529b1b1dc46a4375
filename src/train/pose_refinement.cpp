#include "train/pose_refinement.h"

#include <algorithm>
#include <cmath>

#include "core/rotation_vector.h"

namespace aligngs {
namespace {

// A camera is seen every twentieth step or so: a short memory of sizes, about a hundred of its own visits.
constexpr double kBeta1 = 0.9, kBeta2 = 0.99;
constexpr double kEpsilon = 1e-12;

}  // namespace

Rigidd moved(const Rigidd& base, const CameraMotion& motion) {
  const auto& o = motion.offset;
  if (std::all_of(o.begin(), o.end(), [](double x) { return x == 0; })) return base;  // to the bit
  return Rigidd{rotation_of({o[0], o[1], o[2]}), {o[3], o[4], o[5]}} * base;
}

void update_motion(const PoseGradient<double>& gradient, const PoseRates& rates, CameraMotion& motion) {
  const std::array<double, 6> g = {gradient.rotation.x,    gradient.rotation.y,    gradient.rotation.z,
                                   gradient.translation.x, gradient.translation.y, gradient.translation.z};
  if (!std::all_of(g.begin(), g.end(), [](double x) { return std::isfinite(x); })) return;
  ++motion.updates;
  const double n = static_cast<double>(motion.updates);
  const double correct1 = 1 - std::pow(kBeta1, n), correct2 = 1 - std::pow(kBeta2, n);
  for (size_t k = 0; k < g.size(); ++k) {
    motion.m[k] = kBeta1 * motion.m[k] + (1 - kBeta1) * g[k];
    motion.v[k] = kBeta2 * motion.v[k] + (1 - kBeta2) * g[k] * g[k];
    const double rate = k < 3 ? rates.rotation : rates.translation;
    motion.offset[k] *= 1 - rates.decay;
    motion.offset[k] -= rate * (motion.m[k] / correct1) / (std::sqrt(motion.v[k] / correct2) + kEpsilon);
  }
}

}  // namespace aligngs
