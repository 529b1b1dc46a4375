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

std::string fault_of_matrix(const std::vector<double>& numbers, size_t side) {
  constexpr double kRounding = 1e-6;  // of the focal length, and of the numbers 0 and 1
  for (const double number : numbers) {
    if (!std::isfinite(number)) return "a number is not finite";
  }
  const double fx = numbers[0], fy = numbers[side + 1];
  if (!(fx > 0 && fy > 0)) return "focal lengths must be positive";
  const auto is_zero = [&](size_t row, size_t column) { return std::fabs(numbers[row * side + column]) <= kRounding; };
  const bool last_row = is_zero(2, 0) && is_zero(2, 1) && std::fabs(numbers[2 * side + 2] - 1) <= kRounding;
  if (is_zero(0, 2) && is_zero(1, 2) && !last_row) return "it is column-major: the principal point is in its last row";
  if (std::fabs(numbers[1]) > kRounding * fx || std::fabs(numbers[side]) > kRounding * fy)
    return "skew is not supported, and lens distortion does not stand here";
  if (!last_row) return "its third row is not 0 0 1";
  return {};
}

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
    lens = {k[0], k[1], k[2], k[3], 0, 0, file};
  } else if (k.size() == 9 || k.size() == 16) {
    const size_t row = k.size() == 9 ? 3 : 4;
    if (const std::string fault = fault_of_matrix(k, row); !fault.empty())
      throw_bad_input(file, "matrix", fault, kForm);
    lens = {k[0], k[row + 1], k[2], k[row + 2], 0, 0, file};
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
