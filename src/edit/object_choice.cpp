#include "edit/object_choice.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"

namespace aligngs {
namespace {

constexpr double kAlikeSize = 0.03;   // share: sizes that differ less are equal
constexpr double kAlikePlace = 0.03;  // metres: places that differ less are equal
constexpr double kThinnest = 0.01;    // metres

bool is_place(ObjectChoice choice) {
  return choice == ObjectChoice::kLeft || choice == ObjectChoice::kRight || choice == ObjectChoice::kHighest ||
         choice == ObjectChoice::kLowest;
}

/// A direction is asked of objects on one side of the viewer only.
Vec3d right_of_all(const RoomObjects& objects, const std::vector<size_t>& candidates, const std::string& what) {
  Vec3d middle;
  for (const size_t i : candidates)
    middle += objects[i].centre.cast<double>() * (1.0 / static_cast<double>(candidates.size()));
  const Vec3d right = right_of_viewer(objects.viewpoint(), middle);
  const Vec3d forward = cross(objects.axes().up, right), place = objects.viewpoint().place.value_or(middle);
  for (const size_t i : candidates) {
    if (dot(forward, objects[i].centre.cast<double>() - place) >= 0) continue;
    throw_bad_input({}, "--select", "the cameras are among these objects, so that none is \"" + what + "\"",
                    "name one by its number: " + objects.names(candidates));
  }
  return right;
}

/// The measure of which the chosen object has most; metres and cubic metres.
double measure(const RoomObjects& objects, size_t i, ObjectChoice choice, const Vec3d& right) {
  const ObjectBox& box = objects.box(i);
  const double metre = objects.metre();
  switch (choice) {
    case ObjectChoice::kLargest:
      return box.volume(kThinnest * metre) / (metre * metre * metre);
    case ObjectChoice::kSmallest:
      return -box.volume(kThinnest * metre) / (metre * metre * metre);
    case ObjectChoice::kTallest:
      return box.height() / metre;
    case ObjectChoice::kShortest:
      return -box.height() / metre;
    case ObjectChoice::kWidest:
      return box.length / metre;
    case ObjectChoice::kNarrowest:
      return -box.length / metre;
    case ObjectChoice::kHighest:
      return box.middle_height() / metre;
    case ObjectChoice::kLowest:
      return -box.middle_height() / metre;
    case ObjectChoice::kLeft:
      return -dot(right, objects[i].centre.cast<double>()) / metre;
    default:
      return dot(right, objects[i].centre.cast<double>()) / metre;
  }
}

}  // namespace

size_t chosen_object(const RoomObjects& objects, const std::vector<size_t>& candidates, ObjectChoice choice,
                     const std::string& what) {
  if (candidates.size() == 1) return candidates[0];  // the left one as well as the largest
  Vec3d right;
  if (choice == ObjectChoice::kLeft || choice == ObjectChoice::kRight) right = right_of_all(objects, candidates, what);
  const bool is_size = choice == ObjectChoice::kLargest || choice == ObjectChoice::kSmallest ||
                       choice == ObjectChoice::kWidest || choice == ObjectChoice::kNarrowest;
  if (!is_size) up_of_viewer(objects.viewpoint());
  std::vector<std::pair<double, size_t>> measured;
  for (const size_t i : candidates) measured.emplace_back(-measure(objects, i, choice, right), i);
  std::sort(measured.begin(), measured.end());
  const double alike = is_place(choice) ? kAlikePlace : kAlikeSize * std::abs(measured[0].first);
  std::vector<size_t> equal;
  for (const auto& [value, i] : measured) {
    if (value <= measured[0].first + alike) equal.push_back(i);
  }
  if (equal.size() > 1) {
    std::sort(equal.begin(), equal.end());
    throw_bad_input({}, "--select", "\"" + what + "\" fits these alike: " + objects.names(equal),
                    "name one by its number");
  }
  return measured[0].second;
}

}  // namespace aligngs
