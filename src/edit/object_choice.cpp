#include "edit/object_choice.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "edit/candidate_filter.h"
#include "edit/middle_object.h"
#include "edit/ordered_objects.h"
#include "edit/relation/class_groups.h"

namespace aligngs {
namespace {

constexpr double kAlikeSize = 0.03;   // share: sizes that differ less are equal
constexpr double kAlikePlace = 0.03;  // metres: places that differ less are equal
constexpr double kAlikeColor = 4;     // of lightness, which goes to 100
constexpr double kThinnest = 0.01;    // metres

bool is_place(ObjectChoice choice) {
  return choice == ObjectChoice::kLeft || choice == ObjectChoice::kRight || choice == ObjectChoice::kHighest ||
         choice == ObjectChoice::kLowest;
}

bool is_color(ObjectChoice choice) { return choice == ObjectChoice::kDarkest || choice == ObjectChoice::kLightest; }

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
    case ObjectChoice::kDarkest:
      return -color_of(objects, i).lightness;
    case ObjectChoice::kLightest:
      return color_of(objects, i).lightness;
    case ObjectChoice::kLeft:
      return -dot(right, objects[i].centre.cast<double>()) / metre;
    default:
      return dot(right, objects[i].centre.cast<double>()) / metre;
  }
}

/// Candidates from the one that has most of the choice downwards.
class RankedObjects {
 public:
  RankedObjects(const RoomObjects& objects, const std::vector<size_t>& candidates, ObjectChoice choice,
                const std::string& what)
      : objects_(objects), choice_(choice), what_(what) {
    Vec3d right;
    if (choice == ObjectChoice::kLeft || choice == ObjectChoice::kRight)
      right = right_of_all(objects, candidates, what);
    const bool needs_up = is_place(choice) || choice == ObjectChoice::kTallest || choice == ObjectChoice::kShortest;
    if (needs_up) up_of_viewer(objects.viewpoint());
    for (const size_t i : candidates) measured_.emplace_back(-measure(objects, i, choice, right), i);
    std::sort(measured_.begin(), measured_.end());
  }

  size_t operator[](size_t k) const { return measured_[k].second; }

  /// Error{kBadInput} where the ones before `count` and those from there on are alike.
  void require_border(size_t count) const {
    if (count == 0 || count >= measured_.size()) return;
    const double last = measured_[count - 1].first;
    const double alike = is_place(choice_)   ? kAlikePlace
                         : is_color(choice_) ? kAlikeColor
                                             : kAlikeSize * std::abs(last);
    if (measured_[count].first > last + alike) return;
    std::vector<size_t> equal;
    for (const auto& [value, i] : measured_) {
      if (std::abs(value - last) <= alike) equal.push_back(i);
    }
    std::sort(equal.begin(), equal.end());
    throw_bad_input({}, "--select", "\"" + what_ + "\" fits these alike: " + objects_.names(equal),
                    did_you_mean(objects_, equal) + "Name one by its number");
  }

 private:
  const RoomObjects& objects_;
  ObjectChoice choice_;
  const std::string& what_;
  std::vector<std::pair<double, size_t>> measured_;
};

/// Walls, floor and ceiling are no single things: all walls are mostly one object, or pieces of any size.
void refuse_shell(const RoomObjects& objects, size_t object, const std::string& what) {
  const int label = objects[object].label;
  if (is_of_group(objects.labels(), label, ClassGroup::kThings)) return;
  const std::string& name = objects.labels().classes.at(static_cast<size_t>(label)).name;
  throw_bad_input({}, "--select", "a " + name + " is not told from the rest, so that nothing is \"" + what + "\"",
                  "say \"" + name + "\" for all of it, or draw a part on the page: aligngs view RUN");
}

}  // namespace

size_t chosen_object(const RoomObjects& objects, const std::vector<size_t>& candidates, ObjectChoice choice,
                     const std::string& what, size_t rank) {
  refuse_shell(objects, candidates[0], what);
  if (choice == ObjectChoice::kMiddle && rank == 1) return middle_object(objects, candidates, what);
  if (candidates.size() == 1 && rank == 1) return candidates[0];  // the left one as well as the largest
  if (rank > candidates.size()) {
    throw_bad_input({}, "--select", "there is no \"" + what + "\": the room has " + objects.names(candidates),
                    "name one by its number");
  }
  const RankedObjects ranked(objects, candidates, choice, what);
  ranked.require_border(rank - 1);
  ranked.require_border(rank);
  return ranked[rank - 1];
}

std::vector<size_t> chosen_objects(const RoomObjects& objects, const std::vector<size_t>& candidates,
                                   ObjectChoice choice, size_t count, const std::string& what) {
  refuse_shell(objects, candidates[0], what);
  if (choice == ObjectChoice::kMiddle)
    throw_bad_input({}, "--select", "one object is in the middle, and \"" + what + "\" are several",
                    did_you_mean(objects, candidates) + "Name them by their numbers");
  const RankedObjects ranked(objects, candidates, choice, what);
  ranked.require_border(count);
  std::vector<size_t> out;
  for (size_t k = 0; k < count; ++k) out.push_back(ranked[k]);
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace aligngs
