#include "gaussians/restructure.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace aligngs {
namespace {

bool is_kept(const RowOrigin& origin) { return origin.kind == RowOrigin::Kind::kKeep; }

/// How many rows at the front of a plan are kept ones in rising order, which can move to their places one after the
/// other.
size_t rising_rows(const RestructurePlan& plan) {
  size_t n = 0;
  while (n < plan.rows.size() && is_kept(plan.rows[n]) && (n == 0 || plan.rows[n].source > plan.rows[n - 1].source))
    ++n;
  return n;
}

/// The rows [begin, end) of the plan's result; of new ones their source or, without `copies`, zeros.
void gather(const RestructurePlan& plan, size_t begin, size_t end, size_t width, bool copies,
            const std::vector<float>& rows, float* out) {
  for (size_t i = begin; i < end; ++i, out += width) {
    const RowOrigin& origin = plan.rows[i];
    if (copies || is_kept(origin)) {
      std::copy_n(rows.data() + origin.source * width, width, out);
    } else {
      std::fill_n(out, width, 0.0f);
    }
  }
}

/// Moves the first `count` rows of the plan, in runs of neighbours, to where they belong.
void close_gaps(const RestructurePlan& plan, size_t count, size_t width, std::vector<float>& rows) {
  for (size_t i = 0; i < count;) {
    const size_t source = plan.rows[i].source;
    size_t run = 1;
    while (i + run < count && plan.rows[i + run].source == source + run) ++run;
    if (source != i) std::memmove(rows.data() + i * width, rows.data() + source * width, run * width * sizeof(float));
    i += run;
  }
}

void carry_out(const RestructurePlan& plan, size_t width, bool copies, std::vector<float>& rows) {
  if (width == 0) return rows.clear();  // classes of a model without labels: no memory that could move
  const size_t count = plan.rows.size(), rising = rising_rows(plan);
  if (count * width > rows.capacity() || rising == 0) {
    std::vector<float> out(count * width);
    gather(plan, 0, count, width, copies, rows, out.data());
    rows = std::move(out);
    return;
  }
  std::vector<float> behind((count - rising) * width);  // read before their sources move
  gather(plan, rising, count, width, copies, rows, behind.data());
  close_gaps(plan, rising, width, rows);
  rows.resize(count * width);
  std::copy(behind.begin(), behind.end(), rows.begin() + static_cast<std::ptrdiff_t>(rising * width));
}

}  // namespace

void restructure_model(const RestructurePlan& plan, GaussianModel& model) {
  carry_out(plan, 3, true, model.positions);
  carry_out(plan, 3, true, model.log_scales);
  carry_out(plan, 4, true, model.rotations);
  carry_out(plan, 1, true, model.opacity_logits);
  carry_out(plan, size_t(3) * kShCoefficients, true, model.sh);
  carry_out(plan, static_cast<size_t>(model.semantic_channels), true, model.semantics);
  for (size_t i = 0; i < plan.rows.size(); ++i) {
    const RowOrigin& origin = plan.rows[i];
    if (is_kept(origin)) continue;
    const float log_shrink = std::log(origin.shrink);
    if (!std::isnan(origin.opacity_logit)) model.opacity_logits[i] = origin.opacity_logit;
    for (size_t k = 0; k < 3; ++k) {
      model.positions[3 * i + k] += origin.offset[k];
      if (origin.kind == RowOrigin::Kind::kSplit) model.log_scales[3 * i + k] -= log_shrink;
    }
  }
}

void restructure_rows(const RestructurePlan& plan, size_t width, std::vector<float>& rows) {
  carry_out(plan, width, false, rows);
}

}  // namespace aligngs
