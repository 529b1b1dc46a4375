#include "edit/object_bounds.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/error.h"
#include "core/median.h"
#include "core/quantile.h"
#include "core/vec.h"
#include "gaussians/gaussian_geometry.h"
#include "gaussians/soft_labels.h"

namespace aligngs {
namespace {

constexpr double kStrayPlaces = 0.01;  // share of the places on each side that the size leaves out

double largest_deviation(const GaussianModel& model, size_t i) {
  const float* logs = &model.log_scales[3 * i];
  return std::exp(static_cast<double>(std::max({logs[0], logs[1], logs[2]})));
}

struct ObjectSize {
  Vec3d middle;
  double size = 0;
};

ObjectSize object_size_of(const GaussianModel& model) {
  ObjectSize out;
  Vec3d sides;
  for (int a = 0; a < 3; ++a) {
    std::vector<double> values;
    for (size_t i = 0; i < model.size(); ++i) values.push_back(model.positions[3 * i + static_cast<size_t>(a)]);
    sides[a] = quantile_of(values, 1 - kStrayPlaces) - quantile_of(values, kStrayPlaces);
    out.middle[a] = median_of(std::move(values));
  }
  std::vector<double> deviations;
  for (size_t i = 0; i < model.size(); ++i) deviations.push_back(largest_deviation(model, i));
  out.size = norm(sides) + 6 * median_of(std::move(deviations));
  return out;
}

}  // namespace

void require_object_bounds(const GaussianModel& model, const std::filesystem::path& file, const ObjectBounds& bounds) {
  if (visible_rows(model).empty()) {
    throw_bad_input(file, "opacity", "no Gaussian of the file can be seen: every opacity is below 1/255",
                    "give splats whose opacities are logits, as 3DGS writes them");
  }
  const ObjectSize object = object_size_of(model);
  if (!(object.size <= bounds.most)) {
    throw_bad_input(file, "x, y, z, scale", fmt::format("the object is {:.3g} units large", object.size),
                    fmt::format("scale it to at most {:.0e} units, as metres or millimetres", bounds.most));
  }
  double farthest = 0;
  for (int a = 0; a < 3; ++a) farthest = std::max(farthest, std::fabs(object.middle[a]));
  constexpr double kFloatStep = 1.0 / (1 << 23);  // of a number, between 32-bit neighbours
  if (farthest * kFloatStep > bounds.step * object.size) {
    throw_bad_input(file, "x, y, z",
                    fmt::format("the object of {:.3g} units is {:.3g} units from the origin, where 32-bit numbers "
                                "cannot hold its shape",
                                object.size, farthest),
                    "move it near the origin");
  }
  for (size_t i = 0; i < model.size(); ++i) {
    const double away = norm(position_of(model, i) - object.middle), deviation = largest_deviation(model, i);
    if (!(away <= bounds.farthest * object.size)) {
      throw_bad_input(
          file, "x, y, z",
          fmt::format("Gaussian {} is {:.3g} units from the middle of an object of {:.3g} units", i, away, object.size),
          "remove this stray: exports of the room would lose their fine steps to it");
    }
    if (!(deviation <= bounds.largest * object.size)) {
      throw_bad_input(file, "scale",
                      fmt::format("Gaussian {} has a standard deviation of {:.3g} units in an object of {:.3g} units",
                                  i, deviation, object.size),
                      "remove this Gaussian: it would cover the room");
    }
  }
}

}  // namespace aligngs
