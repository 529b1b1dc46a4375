#include "synth/shared_misjudgement.h"

#include <algorithm>
#include <cmath>

#include "core/angles.h"

namespace aligngs {
namespace {

constexpr double kShortest = 1.0, kLongest = 2.5;  // wavelengths, metres: pieces of furniture and parts of walls
constexpr double kMeanExcess = 0.36;    // mean of excess times |side| where there is excess, for shares of 5 to 25 %
constexpr double kLargestExcess = 1.2;  // nothing is misjudged by more than about three times the mean

}  // namespace

double upper_quantile(double share) {
  if (share <= 0) return 1e9;
  return std::log((1 - share) / share) / 1.702;
}

void SharedMisjudgement::Field::draw(Random& random) {
  for (int i = 0; i < kModes; ++i) {
    const Vec3d direction = normalized(Vec3d{random.normal(), random.normal(), random.normal()});
    waves[i] = direction * (2 * kPi / random.uniform(kShortest, kLongest));
    phases[i] = random.uniform(0, 2 * kPi);
  }
}

double SharedMisjudgement::Field::operator()(const Vec3d& x) const {
  double sum = 0;
  for (int i = 0; i < kModes; ++i) sum += std::cos(dot(waves[i], x) + phases[i]);
  return sum * std::sqrt(2.0 / kModes);
}

SharedMisjudgement::SharedMisjudgement(const SharedMisjudgementOptions& options, Random& random)
    : level_(upper_quantile(options.share)), gain_(options.share > 0 ? options.size / kMeanExcess : 0) {
  where_.draw(random);
  side_.draw(random);
}

double SharedMisjudgement::operator()(const Vec3d& x) const {
  if (gain_ <= 0) return 0;
  const double excess = where_(x) - level_;
  if (excess <= 0) return 0;
  return gain_ * std::min(excess, kLargestExcess) * std::clamp(2 * side_(x), -1.0, 1.0);
}

}  // namespace aligngs
