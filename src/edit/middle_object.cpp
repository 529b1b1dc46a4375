#include "edit/middle_object.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "edit/ordered_objects.h"

namespace aligngs {
namespace {

[[noreturn]] void refuse(const RoomObjects& objects, const std::vector<size_t>& some, const std::string& what,
                         const std::string& why) {
  throw_bad_input({}, "--select", "nothing is clearly \"" + what + "\": " + why + ": " + objects.names(some),
                  did_you_mean(objects, some) + "Name one by its number");
}

/// The middles of the pair that lies farthest apart: the row goes from one to the other.
std::pair<Vec3d, Vec3d> ends_of(const std::vector<Vec3d>& places) {
  std::pair<Vec3d, Vec3d> ends{places[0], places[0]};
  double longest = -1;
  for (size_t i = 0; i < places.size(); ++i) {
    for (size_t j = i + 1; j < places.size(); ++j) {
      const double length = norm(places[j] - places[i]);
      if (length <= longest) continue;
      longest = length;
      ends = {places[i], places[j]};
    }
  }
  return ends;
}

}  // namespace

size_t middle_object(const RoomObjects& objects, const std::vector<size_t>& candidates, const std::string& what) {
  constexpr double kAside = 0.3;     // of the row's length: farther from its line, an object is in no row
  constexpr double kRowStep = 0.05;  // metres between neighbours in the row
  if (candidates.size() == 1) return candidates[0];
  if (candidates.size() % 2 == 0) refuse(objects, candidates, what, "the row has no middle one");
  std::vector<Vec3d> places;
  for (const size_t i : candidates) places.push_back(objects[i].centre.cast<double>());
  const auto [begin, end] = ends_of(places);
  const double length = norm(end - begin);
  if (!(length > 0)) refuse(objects, candidates, what, "they are in one place");
  const Vec3d along = (end - begin) * (1 / length);
  std::vector<std::pair<double, size_t>> row;
  for (size_t k = 0; k < places.size(); ++k) {
    const Vec3d from = places[k] - begin;
    const double at = dot(along, from);
    if (norm(from - along * at) > kAside * length) refuse(objects, candidates, what, "they are no row");
    row.emplace_back(at, candidates[k]);
  }
  std::sort(row.begin(), row.end());
  const size_t middle = row.size() / 2;
  if (std::min(row[middle].first - row[middle - 1].first, row[middle + 1].first - row[middle].first) <
      kRowStep * objects.metre())
    refuse(objects, candidates, what, "some are in one place of the row");
  return row[middle].second;
}

}  // namespace aligngs
