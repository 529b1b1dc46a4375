#include "edit/object_choice.h"

#include <algorithm>
#include <functional>

#include "core/error.h"

namespace aligngs {
namespace {

double volume_of(const Instance& object) {
  constexpr double kThinnest = 0.01;  // scene units; a flat thing is compared by its area
  const Vec3d size = (object.high - object.low).cast<double>();
  return std::max(size.x, kThinnest) * std::max(size.y, kThinnest) * std::max(size.z, kThinnest);
}

/// The measure of which the chosen object has most.
std::function<double(const Instance&)> measure_of(ObjectChoice choice, const std::vector<Instance>& candidates,
                                                  const Viewpoint& viewpoint) {
  if (choice == ObjectChoice::kLargest) return volume_of;
  if (choice == ObjectChoice::kSmallest) return [](const Instance& o) { return -volume_of(o); };
  if (!viewpoint.up) {
    throw_bad_input({}, "--select", "this room does not tell which way is up, so that no object is left or highest",
                    "name the object by its number: `aligngs edit RUN --list` shows them");
  }
  const Vec3d up = *viewpoint.up;
  Vec3d direction = up;
  if (choice == ObjectChoice::kLeft || choice == ObjectChoice::kRight) {
    Vec3d middle;
    for (const Instance& o : candidates)
      middle += o.centre.cast<double>() * (1.0 / static_cast<double>(candidates.size()));
    Vec3d forward = middle - viewpoint.place.value_or(middle);
    forward -= up * dot(forward, up);
    constexpr double kShortest = 1e-6;  // scene units
    if (norm(forward) < kShortest) {
      throw_bad_input({}, "--select", "the cameras are among these objects, so that none is left or right",
                      "name the object by its number: `aligngs edit RUN --list` shows them");
    }
    direction = normalized(cross(forward, up));  // to the right
  }
  const double sign = choice == ObjectChoice::kLeft || choice == ObjectChoice::kLowest ? -1 : 1;
  return [direction, sign](const Instance& o) { return sign * dot(direction, o.centre.cast<double>()); };
}

void choose(std::vector<SelectionTerm>& terms, const std::vector<Instance>& objects, const Viewpoint& viewpoint,
            const LabelSet& labels) {
  for (SelectionTerm& term : terms) {
    if (term.choice == ObjectChoice::kNone) continue;
    std::vector<Instance> candidates;
    for (const Instance& o : objects) {
      if (o.label == term.label) candidates.push_back(o);
    }
    if (candidates.empty()) {
      throw_bad_input(
          {}, "--select",
          "the room has no object that is \"" + labels.classes.at(static_cast<size_t>(term.label)).name + "\"",
          "`aligngs edit RUN --list` shows what it holds");
    }
    // One object is the left one as well as the largest.
    size_t best = 0;
    if (candidates.size() > 1) {
      const auto measure = measure_of(term.choice, candidates, viewpoint);
      for (size_t i = 1; i < candidates.size(); ++i) {
        if (measure(candidates[i]) > measure(candidates[best])) best = i;
      }
    }
    term.instance = candidates[best].number;
    term.choice = ObjectChoice::kNone;
  }
}

}  // namespace

SelectionQuery with_numbers(SelectionQuery query, const std::vector<Instance>& objects, const Viewpoint& viewpoint,
                            const LabelSet& labels) {
  choose(query.include, objects, viewpoint, labels);
  choose(query.exclude, objects, viewpoint, labels);
  return query;
}

}  // namespace aligngs
