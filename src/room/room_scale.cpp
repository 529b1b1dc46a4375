#include "room/room_scale.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "core/error.h"

namespace aligngs {
namespace {

/// Sides by name of everything that has a length.
using Sides = std::map<std::string, std::map<KnownSide, double>>;

Sides sides_of(const MeasuredRoom& room) {
  Sides out;
  out["ceiling"] = {{KnownSide::kHeight, room.height}};
  for (size_t i = 0; i < room.walls.size(); ++i) {
    out[wall_name(i)] = {{KnownSide::kLength, room.walls[i].length()},
                         {KnownSide::kWidth, room.walls[i].length()},
                         {KnownSide::kHeight, room.walls[i].height}};
  }
  for (size_t i = 0; i < room.openings.size(); ++i) {
    const MeasuredOpening& o = room.openings[i];
    out[opening_name(room, i)] = {{KnownSide::kWidth, o.right - o.left}, {KnownSide::kHeight, o.top - o.bottom}};
  }
  for (const MeasuredBox& b : room.boxes) {
    out[box_name(b)] = {{KnownSide::kWidth, b.width},
                        {KnownSide::kDepth, b.depth},
                        {KnownSide::kHeight, b.top - b.bottom},
                        {KnownSide::kLength, std::max(b.width, b.depth)}};
  }
  return out;
}

}  // namespace

double measured_side(const MeasuredRoom& room, const std::string& name, KnownSide side) {
  const Sides sides = sides_of(room);
  std::string names, several;
  std::optional<std::string> only;
  for (const auto& [own, lengths] : sides) {
    names += (names.empty() ? "" : ", ") + own;
    if (own.substr(0, own.rfind('.')) != name) continue;
    several += (several.empty() ? "" : ", ") + own;
    only = own;
  }
  const auto exact = sides.find(name);
  if (exact == sides.end() && several.find(',') != std::string::npos)
    throw_usage("several things are called " + name.substr(0, 40), "name one of: " + several);
  if (exact == sides.end() && !only)
    throw_usage("there is no \"" + name.substr(0, 40) + "\" in room.json", "there are: " + names);
  const auto& lengths = exact != sides.end() ? exact->second : sides.at(*only);
  const auto length = lengths.find(side);
  if (length == lengths.end())
    throw_usage(name.substr(0, 40) + " has no such side", "give another of --height, --width, --depth, --length");
  return length->second;
}

MeasuredRoom scaled_to(const MeasuredRoom& room, double measured, double metres) {
  if (!(metres > 0) || !std::isfinite(metres)) throw_usage("a length must be positive", "give metres, for example 0.9");
  if (!(measured > 0) || !std::isfinite(measured))
    throw_usage("the measured length is zero", "choose two different points");
  const double factor = metres / measured;
  constexpr double kMost = 1e4;  // a scene in millimetres has a thousand; more is a slip of the finger
  if (factor > kMost || factor < 1 / kMost)
    throw_usage("the scale would change by a factor of more than ten thousand", "check the length: it is in metres");
  constexpr double kRounding = 1e-9;  // the same length again changes nothing, not even last digits
  const bool known = room.metric && room.scale_source == ScaleSource::kGiven;
  if (known && std::fabs(factor - 1) < kRounding) return room;
  MeasuredRoom out = rescaled(room, factor);
  out.metric = true;
  out.scale_source = ScaleSource::kGiven;
  return out;
}

MeasuredRoom scaled_between(const MeasuredRoom& room, const Vec3d& from, const Vec3d& to, double metres) {
  return scaled_to(room, norm(from - to) * room.to_room.scale, metres);
}

}  // namespace aligngs
