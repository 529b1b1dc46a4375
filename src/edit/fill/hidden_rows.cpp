#include "edit/fill/hidden_rows.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "edit/object_rows.h"
#include "gaussians/gaussian_geometry.h"

namespace aligngs {
namespace {

/// Standard deviation along the longest axis, scene units.
double widest_of(const GaussianModel& model, size_t row) {
  const float* s = &model.log_scales[3 * row];
  return std::exp(static_cast<double>(std::max({s[0], s[1], s[2]})));
}

}  // namespace

void mark_hidden_rows(const FillRoom& r, std::vector<uint8_t>& debris) {
  std::vector<uint8_t> unseen(debris.size(), 0);
  r.for_each(debris.size(), [&](size_t i) {
    unseen[i] = !r.input.selected[i] && !debris[i] && r.hidden.from_all(position_of(r.room.model, i));
  });
  std::map<ObjectName, std::vector<uint32_t>> shown, hidden;
  for (uint32_t i = 0; i < debris.size(); ++i) {
    const ObjectName thing{r.room.labels.label[i], r.room.labels.instance[i]};
    if (unseen[i])
      hidden[thing].push_back(i);
    else if (!debris[i] && !r.input.selected[i])
      shown[thing].push_back(i);
  }
  const double wide = r.settings.blur * r.extent;
  for (const auto& group : hidden) {  // clang 14 captures no structured binding in a lambda
    const ObjectName& thing = group.first;
    const std::vector<uint32_t>& rows = group.second;
    const bool has_class = thing.first < r.classes.size();
    if (has_class && r.classes[thing.first].shell != PlaneKind::kNone) {
      for (const uint32_t i : rows) debris[i] = 1;
      continue;
    }
    const Stains::Surface surface = r.stains.surface_of(shown[thing]);
    r.for_each(rows.size(), [&](size_t k) {
      debris[rows[k]] = widest_of(r.room.model, rows[k]) > wide || r.stains.is_foreign(rows[k], surface);
    });
  }
}

}  // namespace aligngs
