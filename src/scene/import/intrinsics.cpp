#include "scene/import/intrinsics.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "core/error.h"
#include "scene/import/capture_text.h"

namespace aligngs {
namespace {

constexpr double kAlike = 1.06;     // lenses are a few hundredths of the side off the middle
constexpr double kDifferent = 1.2;  // from here on another size explains more than a lens does

/// How far a is from b, as a factor of at least 1.
double factor(double a, double b) { return std::fmax(a / b, b / a); }

}  // namespace

Intrinsics read_intrinsics(const std::filesystem::path& file) {
  constexpr const char* kForm = "write fx 0 cx / 0 fy cy / 0 0 1, or fx fy cx cy";
  const std::vector<double> k = [&] {
    try {
      return read_numbers(file);
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::kBadInput) throw;
      throw_bad_input(file, error.details().field, error.details().message, kForm);
    }
  }();
  Intrinsics lens;
  if (k.size() == 4) {
    lens = {k[0], k[1], k[2], k[3]};
  } else if (k.size() == 9 || k.size() == 16) {
    const size_t row = k.size() == 9 ? 3 : 4;
    lens = {k[0], k[row + 1], k[2], k[row + 2]};
  } else {
    throw_bad_input(file, "matrix", fmt::format("expected a 3x3 or 4x4 matrix, found {} numbers", k.size()), kForm);
  }
  if (!(std::isfinite(lens.fx) && std::isfinite(lens.fy) && lens.fx > 0 && lens.fy > 0))
    throw_bad_input(file, "fx, fy", "focal lengths must be positive", kForm);
  return lens;
}

std::string misfit_of_intrinsics(double cx, double cy, int width, int height) {
  const std::string photo = fmt::format("a photo of {} x {}", width, height);
  const std::string point = fmt::format("the principal point ({:.6g}, {:.6g})", cx, cy);
  if (!(cx > 0 && cy > 0 && cx < width && cy < height)) return point + " lies outside of " + photo;
  const double x = 2 * cx / width, y = 2 * cy / height;  // 1: in the middle
  const std::string meant = fmt::format("{:.0f} x {:.0f}", 2 * cx, 2 * cy);
  if (factor(x, y) < kAlike && factor(x, 1) > kDifferent)
    return fmt::format("{} is the middle of photos of about {}, and this is {}", point, meant, photo);
  const double turned_x = 2 * cx / height, turned_y = 2 * cy / width;
  const bool turning_shows = factor(width, height) > kDifferent;  // not in nearly square photos
  if (turning_shows && factor(x, y) > kDifferent && factor(turned_x, turned_y) < kAlike)
    return fmt::format("{} is that of photos of about {} before they were turned by a quarter, and this is {}", point,
                       meant, photo);
  return {};
}

}  // namespace aligngs
