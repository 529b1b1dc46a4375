#include "refine/match_covariance.h"

#include <algorithm>
#include <cmath>

namespace aligngs {
namespace {

constexpr double kBlob = 2;  // pixels of a patch that differ from the other photo's together
// of 1 - score: no two photos of a place are more alike than their noise lets them be
constexpr double kLeastMisfit = 0.01;
constexpr double kLeastCurvature = 1e-4;  // per square pixel; less is a ridge, and what is measured along it is noise

}  // namespace

MatchCovariance match_covariance(const std::array<double, 9>& scores, size_t pixels) {
  const double best = scores[4];
  const double xx = 2 * best - scores[3] - scores[5], yy = 2 * best - scores[1] - scores[7];
  const double xy = (scores[2] + scores[6] - scores[0] - scores[8]) / 4;
  // H = sharp * (c, s)(c, s)' + blunt * (-s, c)(-s, c)'
  const double mean = 0.5 * (xx + yy), apart = std::hypot(0.5 * (xx - yy), xy);
  const double sharp = std::max(mean + apart, kLeastCurvature), blunt = std::max(mean - apart, kLeastCurvature);
  const double angle = 0.5 * std::atan2(2 * xy, xx - yy), c = std::cos(angle), s = std::sin(angle);
  const double noise = 2 * kBlob * std::max(1 - best, kLeastMisfit) / static_cast<double>(pixels);
  const double along = noise / blunt, across = noise / sharp;
  return {c * c * across + s * s * along, c * s * (across - along), s * s * across + c * c * along};
}

std::array<double, 3> whitening(const MatchCovariance& covariance, double deviation) {
  const double xx = covariance.xx + deviation * deviation, yy = covariance.yy + deviation * deviation,
               xy = covariance.xy;
  const double determinant = xx * yy - xy * xy;
  // The inverse is (yy, -xy; -xy, xx) / determinant; W'W has the lower right element w_yy^2.
  const double w_yy = std::sqrt(xx / determinant);
  return {1 / std::sqrt(xx), -xy / (determinant * w_yy), w_yy};
}

}  // namespace aligngs
