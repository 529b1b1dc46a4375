#include "edit/length_unit.h"

#include <fmt/format.h>

#include "room/measured_room.h"
#include "room/room_json.h"

namespace aligngs {
namespace {

constexpr double kCentimetres = 100;  // of a metre

}  // namespace

LengthUnit length_unit_of(const std::filesystem::path& run, const Scene& scene) {
  const std::filesystem::path file = run / "room.json";
  if (std::filesystem::exists(file)) {
    const MeasuredRoom measured = read_room(file);
    if (measured.metric) return {measured.to_room.scale, measured.scale_source == ScaleSource::kNetwork};
  }
  if (!scene.metric) return {};
  return {1.0, scene.units_estimate.has_value()};
}

std::string length_to_type(double length, const LengthUnit& unit) {
  return unit.metres ? fmt::format("{:.0f} cm", kCentimetres * *unit.metres * length) : fmt::format("{:.2g}", length);
}

std::string length_text(double length, const LengthUnit& unit) {
  return length_to_type(length, unit) + (!unit.metres ? " scene units" : unit.estimated ? " (estimated)" : "");
}

std::string sides_text(const Vec3d& sides, const LengthUnit& unit) {
  if (!unit.metres) return fmt::format("{:.2f} x {:.2f} x {:.2f} units", sides.x, sides.y, sides.z);
  const double cm = kCentimetres * *unit.metres;
  return fmt::format("{:.0f} x {:.0f} x {:.0f} cm", cm * sides.x, cm * sides.y, cm * sides.z);
}

}  // namespace aligngs
