#include "gaussians/mcmc_growth.h"

#include <algorithm>
#include <cmath>

#include "gaussians/morton_order.h"

namespace aligngs {
namespace {

constexpr int kMostCopies = 51;  // of one row in one call, as there: binomial sums beyond lose their digits
constexpr double kGrowthOpacityMargin = 1e-6;  // keeps logits finite

double exact_opacity(const GaussianModel& model, size_t i) {
  return 1 / (1 + std::exp(-static_cast<double>(model.opacity_logits[i])));
}

float logit(double o) {
  o = std::clamp(o, kGrowthOpacityMargin, 1 - kGrowthOpacityMargin);
  return static_cast<float>(std::log(o / (1 - o)));
}

/// Draws of living rows in proportion to their opacity.
class Lottery {
 public:
  Lottery(const GaussianModel& model, float dead) {
    for (size_t i = 0; i < model.size(); ++i) {
      const double o = exact_opacity(model, i);
      if (!(o > static_cast<double>(dead))) continue;  // NaN is dead
      sum_ += o;
      rows_.push_back(static_cast<uint32_t>(i));
      sums_.push_back(sum_);
    }
  }
  size_t living() const { return rows_.size(); }
  const std::vector<uint32_t>& rows() const { return rows_; }
  /// Index into rows().
  size_t draw(Random& random) const {
    const double at = random.uniform(0, sum_);
    const auto it = std::upper_bound(sums_.begin(), sums_.end(), at);
    return std::min(static_cast<size_t>(it - sums_.begin()), rows_.size() - 1);
  }

 private:
  std::vector<uint32_t> rows_;
  std::vector<double> sums_;
  double sum_ = 0;
};

}  // namespace

SharedShape shared_shape(double opacity, int copies) {
  const double each = 1 - std::pow(1 - opacity, 1.0 / copies);
  double denominator = 0;
  for (int i = 1; i <= copies; ++i) {
    double binomial = 1, power = each, sign = 1;  // C(i - 1, k), each^(k + 1), (-1)^k
    for (int k = 0; k < i; ++k) {
      denominator += sign * binomial * power / std::sqrt(k + 1.0);
      binomial *= static_cast<double>(i - 1 - k) / (k + 1);
      power *= each;
      sign = -sign;
    }
  }
  return {each, opacity > 0 ? denominator / opacity : 1};
}

RestructurePlan plan_mcmc_growth(const GaussianModel& model, const McmcRule& rule, Random& random) {
  const size_t n = model.size();
  const Lottery lottery(model, rule.dead_opacity);
  if (lottery.living() == 0) return plan_keep(std::vector<uint8_t>(n, 1));
  const size_t wanted = std::min(rule.max_gaussians, static_cast<size_t>(rule.growth * static_cast<double>(n)));
  std::vector<int> copies(lottery.living(), 1);
  for (size_t k = lottery.living(); k < std::max(n, wanted); ++k) ++copies[lottery.draw(random)];
  RestructurePlan plan;
  plan.pruned = n - lottery.living();
  std::vector<RowOrigin> added;
  for (size_t j = 0; j < copies.size(); ++j) {
    const uint32_t row = lottery.rows()[j];
    RowOrigin origin;
    origin.source = row;
    if (copies[j] > 1) {
      const SharedShape shape = shared_shape(exact_opacity(model, row), std::min(copies[j], kMostCopies));
      origin.kind = RowOrigin::Kind::kSplit;
      origin.shrink = static_cast<float>(shape.shrink);
      origin.opacity_logit = logit(std::max(shape.opacity, static_cast<double>(rule.dead_opacity)));
      added.insert(added.end(), static_cast<size_t>(copies[j] - 1), origin);
      plan.cloned += static_cast<size_t>(copies[j] - 1);
    }
    plan.rows.push_back(origin);
  }
  plan.rows.insert(plan.rows.end(), added.begin(), added.end());
  if (rule.morton_order) sort_by_morton(model, plan);
  return plan;
}

}  // namespace aligngs
