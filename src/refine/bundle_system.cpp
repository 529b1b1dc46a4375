#include "refine/bundle_system.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/angles.h"
#include "core/rotation_vector.h"
#include "refine/bundle_points.h"

namespace aligngs {
namespace {

constexpr size_t kShares = 16;                     // of the work: enough for as many threads
constexpr size_t kSumsMemory = size_t{128} << 20;  // bytes, of all shares' sums

/// Deviations of what the priors hold, by ViewLane.
std::array<double, kLanes> prior_sigmas(const BundleSettings& settings, double extent) {
  const double turn = settings.rotation * kRadiansPerDegree, shift = settings.centre * extent;
  return {turn, turn, turn, shift, shift, shift, settings.focal, settings.depth_scale};
}

/// How far a view is from its prior, by ViewLane. Rotations are small, so their vectors add.
std::array<double, kLanes> prior_errors(const BundleState& at, size_t view, const Camera& anchor) {
  const Camera& now = at.cameras[view];
  const Vec3d turn = rotation_vector_of(now.world_to_camera.rotation * transpose(anchor.world_to_camera.rotation)),
              shift = now.centre() - anchor.centre();
  return {turn.x, turn.y, turn.z, shift.x, shift.y, shift.z, at.log_focal, at.log_scales[view]};
}

}  // namespace

BundleSystem::BundleSystem(const BundleProblem& problem, const BundleSettings& settings, ThreadPool& pool)
    : problem_(problem), settings_(settings), pool_(pool) {
  take_terms();
  share_out();
}

void BundleSystem::take_terms() {
  // All depths of a view together weigh as much as its independent ones.
  std::vector<double> depths(problem_.cameras.size(), 0.0);
  std::vector<const Observation*> used;
  first_.assign(problem_.points.size() + 1, 0);
  std::vector<int> number(problem_.cameras.size(), -1);  // among the views that take part
  for (const Observation& o : problem_.observations) {
    const size_t view = static_cast<size_t>(o.view), point = static_cast<size_t>(o.point);
    depths[view] += o.prior_depth > 0;
    if (!((problem_.cameras[view].world_to_camera * problem_.points[point]).z > kNearestPoint)) continue;
    used.push_back(&o);
    number[view] = 0;
    ++first_[point + 1];
  }
  for (size_t p = 1; p < first_.size(); ++p) first_[p] += first_[p - 1];
  for (size_t v = 0; v < number.size(); ++v) {
    if (number[v] < 0) continue;
    number[v] = static_cast<int>(views_.size());
    views_.push_back(v);
    const double pose = problem_.fixed.empty() || !problem_.fixed[v] ? 1 : 0, focal = settings_.focal > 0 ? 1 : 0;
    unknown_.push_back({{pose, pose, pose, pose, pose, pose, focal, 0}});
  }
  terms_.resize(used.size());
  std::vector<size_t> next(first_.begin(), first_.end() - 1);
  for (const Observation* o : used) {
    const size_t view = static_cast<size_t>(o->view);
    BundleTerm term{number[view], o->point, o->pixel, whitening(o->covariance, settings_.pixel), 0, 0};
    if (o->prior_depth > 0) {
      term.log_depth = std::log(o->prior_depth);
      term.depth_sigma = settings_.depth * std::sqrt(std::max(1.0, depths[view] / settings_.depth_independent));
      unknown_[static_cast<size_t>(term.view)][kScaleLane] = 1;
    }
    terms_[next[static_cast<size_t>(o->point)]++] = term;
  }
}

void BundleSystem::share_out() {
  const size_t bytes = std::max<size_t>(block_of(views_.size(), 0) * sizeof(Lanes), 1);
  const size_t shares = std::clamp<size_t>(kSumsMemory / bytes, 1, kShares);
  for (size_t share = 0; share < shares; ++share) {
    const auto at = std::lower_bound(first_.begin(), first_.end() - 1, terms_.size() * share / shares);
    chunks_.push_back(static_cast<size_t>(at - first_.begin()));
  }
  chunks_.push_back(problem_.points.size());
}

BundleState BundleSystem::start() const {
  BundleState out{{}, problem_.points, std::vector<double>(views_.size(), 0.0), 0};
  for (const size_t v : views_) out.cameras.push_back(problem_.cameras[v]);
  return out;
}

template <class Visit>
void BundleSystem::for_priors(const BundleState& at, const Visit& visit) const {
  const std::array<double, kLanes> sigma = prior_sigmas(settings_, problem_.extent);
  for (size_t v = 0; v < at.cameras.size(); ++v) {
    const auto errors =
        prior_errors(at, v, problem_.anchors.empty() ? problem_.cameras[views_[v]] : problem_.anchors[views_[v]]);
    for (int lane = 0; lane < kLanes; ++lane) {
      const bool once = lane != kFocalLane || v == 0;  // all views share the focal length
      if (unknown_[v][lane] > 0 && once)
        visit(v, lane, errors[static_cast<size_t>(lane)], sigma[static_cast<size_t>(lane)]);
    }
  }
}

double BundleSystem::cost(const BundleState& at) const {
  std::vector<double> of_share(chunks_.size() - 1, 0.0);
  pool_.parallel_for(of_share.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t share = begin; share < end; ++share) {
      for (size_t t = first_[chunks_[share]]; t < first_[chunks_[share + 1]]; ++t)
        of_share[share] += term_cost(terms_[t], at);
    }
  });
  double cost = 0;
  for_priors(at, [&](size_t, int, double error, double sigma) { cost += 0.5 * (error / sigma) * (error / sigma); });
  for (const double share : of_share) cost += share;
  return cost;
}

std::optional<BundleStep> BundleSystem::step(const BundleState& at, double radius) const {
  const size_t views = at.cameras.size();
  std::vector<TermLink> links(terms_.size());
  std::vector<PointEquations> points(problem_.points.size());
  std::vector<ViewSums> shares(chunks_.size() - 1, ViewSums(views));
  const auto share = [&](size_t s) -> PointShare {
    return {at, terms_, first_, unknown_, problem_.fixed_points, radius, chunks_[s], chunks_[s + 1]};
  };
  pool_.parallel_for(shares.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t s = begin; s < end; ++s) eliminate_points(share(s), shares[s], links.data(), points.data());
  });
  ViewSums sums(views);
  for (const ViewSums& s : shares) sums.add(s);
  if (!sums.in_front) return {};
  for_priors(at, [&](size_t v, int lane, double error, double sigma) {
    const double weight = 1 / (sigma * sigma);
    sums.gradient[v][lane] += weight * error;
    sums.diagonal[v][lane] += weight;
    sums.blocks[block_of(v, v) + static_cast<size_t>(lane)][lane] += weight;
  });

  // One column per unknown; the shared focal length is the last.
  const Eigen::Index own = kLanes - 1, focal = own * static_cast<Eigen::Index>(views), size = focal + 1;
  const auto column = [&](size_t view, int lane) {
    if (lane == kFocalLane) return focal;
    return own * static_cast<Eigen::Index>(view) + (lane < kFocalLane ? lane : lane - 1);
  };
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(size), reduced = gradient, damped = gradient;
  for (size_t a = 0; a < views; ++a) {
    for (int i = 0; i < kLanes; ++i) {
      gradient[column(a, i)] += sums.gradient[a][i];
      reduced[column(a, i)] += sums.gradient[a][i] + sums.reduced[a][i];
      damped[column(a, i)] += sums.diagonal[a][i];
      for (size_t b = 0; b <= a; ++b) {
        const Lanes& row = sums.blocks[block_of(a, b) + static_cast<size_t>(i)];
        for (int j = 0; j < kLanes; ++j) {
          matrix(column(a, i), column(b, j)) += row[j];
          if (b < a) matrix(column(b, j), column(a, i)) += row[j];
        }
      }
    }
  }
  for (Eigen::Index i = 0; i < size; ++i) {
    damped[i] = damped[i] > 0 ? bundle_damping(damped[i], radius) : 1;  // 1: not solved for
    matrix(i, i) += damped[i];
  }
  const Eigen::LLT<Eigen::MatrixXd> factors(matrix);
  if (factors.info() != Eigen::Success) return {};
  const Eigen::VectorXd solution = -factors.solve(reduced);
  if (!solution.allFinite()) return {};

  BundleStep out;
  out.decrease = 0.5 * (-gradient.dot(solution) + solution.cwiseAbs2().dot(damped));
  for (size_t v = 0; v < views; ++v) {
    Lanes lanes{};
    for (int i = 0; i < kLanes; ++i) lanes[i] = solution[column(v, i)];
    out.views.push_back(lanes);
  }
  if (problem_.fixed_points) return out;
  out.points.assign(problem_.points.size(), Vec3d{});
  std::vector<double> decrease(shares.size(), 0.0);
  pool_.parallel_for(shares.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t s = begin; s < end; ++s)
      decrease[s] = point_steps(share(s), out.views, links.data(), points.data(), out.points.data());
  });
  for (const double d : decrease) out.decrease += d;
  return out;
}

BundleState BundleSystem::moved(const BundleState& at, const BundleStep& step) const {
  BundleState out = at;
  if (!step.views.empty()) out.log_focal += step.views.front()[kFocalLane];
  for (size_t v = 0; v < out.cameras.size(); ++v) {
    out.cameras[v] = moved_camera(at.cameras[v], step.views[v]);
    out.log_scales[v] += step.views[v][kScaleLane];
  }
  for (size_t p = 0; p < step.points.size(); ++p) out.points[p] += step.points[p];
  return out;
}

}  // namespace aligngs
