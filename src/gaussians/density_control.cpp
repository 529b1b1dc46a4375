#include "gaussians/density_control.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "core/error.h"
#include "gaussians/morton_order.h"

namespace aligngs {
namespace {

constexpr int kSplitChildren = 2;     // 3DGS: one large Gaussian becomes two
constexpr float kSplitShrink = 1.6f;  // 3DGS: 0.8 * number of children

enum class Growth : uint8_t { kNone, kClone, kSplit };

struct Candidate {
  uint32_t row;
  float priority;  // the gradient that asked for growth, relative to its threshold
};

void require_size(const std::vector<float>& values, size_t n, const char* name) {
  if (values.size() == n) return;
  throw Error({ErrorKind::kFailed,
               std::string("density statistics '") + name + "' have " + std::to_string(values.size()) +
                   " entries for " + std::to_string(n) + " Gaussians",
               {},
               {},
               {}});
}

float largest_scale(const GaussianModel& model, size_t i) {
  const float* s = &model.log_scales[3 * i];
  return std::exp(std::max(s[0], std::max(s[1], s[2])));
}

float opacity(const GaussianModel& model, size_t i) { return 1.0f / (1.0f + std::exp(-model.opacity_logits[i])); }

/// The value below which a share q of the seen rows' mean residuals lies; -infinity when nothing was seen.
float residual_threshold(const DensityStatistics& s, float q) {
  std::vector<float> means;
  for (size_t i = 0; i < s.weight.size(); ++i) {
    if (s.weight[i] > 0) means.push_back(s.residual[i] / s.weight[i]);
  }
  if (means.empty()) return -std::numeric_limits<float>::infinity();
  const size_t k = std::min(means.size() - 1, static_cast<size_t>(q * static_cast<float>(means.size())));
  std::nth_element(means.begin(), means.begin() + static_cast<std::ptrdiff_t>(k), means.end());
  return means[k];
}

/// Leaves only the `count` candidates of highest priority; equal priorities keep the lower row.
void keep_largest(std::vector<Candidate>& candidates, size_t count) {
  if (candidates.size() <= count) return;
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.priority != b.priority ? a.priority > b.priority : a.row < b.row;
  });
  candidates.resize(count);
}

/// Rows that are removed in any case: transparent ones (their copies would be as transparent).
bool is_transparent(const GaussianModel& model, size_t i, const DensityRule& rule) {
  return !(opacity(model, i) >= rule.prune_opacity);
}

bool is_oversized(float scale, const DensityRule& rule) { return rule.prune_scale > 0 && scale > rule.prune_scale; }

class Planner {
 public:
  Planner(const GaussianModel& model, const DensityStatistics& statistics, const DensityRule& rule)
      : model_(model), statistics_(statistics), rule_(rule), growth_(model.size(), Growth::kNone) {}

  void choose_growth() {
    const size_t n = model_.size();
    require_size(statistics_.gradient, n, "gradient");
    require_size(statistics_.visible, n, "visible");
    if (rule_.gradient_abs_threshold > 0) {
      require_size(statistics_.gradient_abs, n, "gradient_abs");
      require_size(statistics_.radius, n, "radius");
    }
    float residual_min = -std::numeric_limits<float>::infinity();
    if (rule_.residual_quantile > 0 || rule_.unsupported_min > 0) require_size(statistics_.weight, n, "weight");
    if (rule_.unsupported_min > 0) require_size(statistics_.unsupported, n, "unsupported");
    if (rule_.residual_quantile > 0) {
      require_size(statistics_.residual, n, "residual");
      residual_min = residual_threshold(statistics_, rule_.residual_quantile);
    }
    std::vector<Candidate> by_gradient, by_absolute;
    for (size_t i = 0; i < n; ++i) {
      if (statistics_.visible[i] <= 0 || is_transparent(model_, i, rule_) || !may_grow(i, residual_min)) continue;
      const float gradient = statistics_.gradient[i] / statistics_.visible[i];
      if (gradient >= rule_.gradient_threshold) {
        by_gradient.push_back({static_cast<uint32_t>(i), gradient / rule_.gradient_threshold});
      } else if (splits_by_absolute(i)) {
        by_absolute.push_back({static_cast<uint32_t>(i),
                               statistics_.gradient_abs[i] / statistics_.visible[i] / rule_.gradient_abs_threshold});
      }
    }
    keep_largest(by_absolute, rule_.abs_max_splits);
    by_gradient.insert(by_gradient.end(), by_absolute.begin(), by_absolute.end());
    if (rule_.max_gaussians > 0) keep_largest(by_gradient, room());
    for (const Candidate& c : by_gradient) {
      growth_[c.row] = largest_scale(model_, c.row) <= rule_.small_scale ? Growth::kClone : Growth::kSplit;
    }
  }

  RestructurePlan plan(Random& random) const {
    RestructurePlan plan;
    std::vector<RowOrigin> clones, children;
    for (size_t i = 0; i < growth_.size(); ++i) {
      if (is_transparent(model_, i, rule_)) {
        ++plan.pruned;
        continue;
      }
      const uint32_t row = static_cast<uint32_t>(i);
      if (growth_[i] == Growth::kSplit) {
        ++plan.split;
        const bool oversized = is_oversized(largest_scale(model_, i) / kSplitShrink, rule_);
        for (int k = 0; k < kSplitChildren; ++k) {
          const RowOrigin child = displaced(row, RowOrigin::Kind::kSplit, kSplitShrink, random);
          if (!oversized) children.push_back(child);
        }
        if (oversized) ++plan.pruned;
        continue;
      }
      if (growth_[i] == Growth::kClone) {
        ++plan.cloned;
        clones.push_back(displaced(row, RowOrigin::Kind::kClone, 1.0f, random));
      }
      if (is_oversized(largest_scale(model_, i), rule_)) {
        ++plan.pruned;
      } else {
        plan.rows.push_back({row});
      }
    }
    plan.rows.insert(plan.rows.end(), clones.begin(), clones.end());
    plan.rows.insert(plan.rows.end(), children.begin(), children.end());
    return plan;
  }

 private:
  bool may_grow(size_t i, float residual_min) const {
    const bool asks_weight = rule_.residual_quantile > 0 || rule_.unsupported_min > 0;
    if (asks_weight && !(statistics_.weight[i] > 0)) return false;
    if (rule_.residual_quantile > 0 && statistics_.residual[i] / statistics_.weight[i] < residual_min) return false;
    return rule_.unsupported_min <= 0 || statistics_.unsupported[i] / statistics_.weight[i] >= rule_.unsupported_min;
  }

  bool splits_by_absolute(size_t i) const {
    return rule_.gradient_abs_threshold > 0 && statistics_.radius[i] > rule_.abs_min_radius &&
           statistics_.gradient_abs[i] / statistics_.visible[i] >= rule_.gradient_abs_threshold &&
           largest_scale(model_, i) > rule_.small_scale;
  }

  /// How many rows may be added: a clone adds one, and so does a split (two children for one parent).
  size_t room() const {
    size_t staying = 0;
    for (size_t i = 0; i < model_.size(); ++i) staying += is_transparent(model_, i, rule_) ? 0 : 1;
    return rule_.max_gaussians > staying ? rule_.max_gaussians - staying : 0;
  }

  /// A copy displaced by a draw from the Gaussian itself, N(0, R S S^T R^T).
  RowOrigin displaced(uint32_t row, RowOrigin::Kind kind, float shrink, Random& random) const {
    const float* s = &model_.log_scales[3 * size_t(row)];
    const float* q = &model_.rotations[4 * size_t(row)];
    Vec3d local;
    for (int k = 0; k < 3; ++k) local[k] = random.normal() * std::exp(static_cast<double>(s[k]));
    const Vec3d world = rotation_matrix(normalized(Quaterniond{q[0], q[1], q[2], q[3]})) * local;
    return {row, kind, {static_cast<float>(world.x), static_cast<float>(world.y), static_cast<float>(world.z)}, shrink};
  }

  const GaussianModel& model_;
  const DensityStatistics& statistics_;
  const DensityRule& rule_;
  std::vector<Growth> growth_;
};

}  // namespace

RestructurePlan plan_density_control(const GaussianModel& model, const DensityStatistics& statistics,
                                     const DensityRule& rule, Random& random) {
  Planner planner(model, statistics, rule);
  if (rule.grow) planner.choose_growth();
  RestructurePlan plan = planner.plan(random);
  if (rule.morton_order) sort_by_morton(model, plan);
  return plan;
}

RestructurePlan plan_keep(const std::vector<uint8_t>& keep) {
  RestructurePlan plan;
  for (size_t i = 0; i < keep.size(); ++i) {
    if (keep[i]) {
      plan.rows.push_back({static_cast<uint32_t>(i)});
    } else {
      ++plan.pruned;
    }
  }
  return plan;
}

}  // namespace aligngs
