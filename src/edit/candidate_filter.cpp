#include "edit/candidate_filter.h"

#include <algorithm>
#include <array>

#include "core/error.h"
#include "core/median.h"
#include "core/spherical_harmonics.h"
#include "edit/ordered_objects.h"
#include "edit/row_flags.h"
#include "gaussians/gaussian_geometry.h"

namespace aligngs {
namespace {

std::string colors_of(const RoomObjects& objects, const std::vector<size_t>& some) {
  constexpr size_t kMost = 6;
  std::string text;
  for (size_t k = 0; k < some.size() && k < kMost; ++k)
    text += (k ? ", " : "") + objects.name(some[k]) + " is " + plain_color_word(color_of(objects, some[k]));
  return text;
}

bool stands(const RoomObjects& objects, const ObjectRelations& relations, size_t object, NarrowPlace place) {
  constexpr double kBedside = 0.6;  // metres
  for (size_t i = 0; i < objects.size(); ++i) {
    const std::string& name = objects.labels().classes.at(static_cast<size_t>(objects[i].label)).name;
    if (place == NarrowPlace::kAtBed && name == "bed" && objects.gap(object, i) <= kBedside) return true;
    if (place == NarrowPlace::kOnFloor && name == "floor" && relations.gap_where(object, Relation::kOn, i)) return true;
  }
  return place == NarrowPlace::kOnFurniture && relations.is_carried(object);
}

}  // namespace

SeenColor color_of(const RoomObjects& objects, size_t object) {
  const GaussianModel& model = objects.room().model;
  std::array<std::vector<float>, 3> channels;
  for (int pass = 0; pass < 2 && channels[0].empty(); ++pass) {
    for (const uint32_t row : objects.rows(object)) {
      if (pass == 0 && opacity_of(model, row) < kSolidOpacity) continue;
      for (size_t c = 0; c < 3; ++c)
        channels[c].push_back(0.5f + static_cast<float>(kSh0) * model.sh[3 * kShCoefficients * row + c]);
    }
  }
  return seen_color(median_of(std::move(channels[0])), median_of(std::move(channels[1])),
                    median_of(std::move(channels[2])));
}

std::vector<size_t> of_color(const RoomObjects& objects, const std::vector<size_t>& candidates,
                             const SelectionTerm& term, const std::string& what) {
  std::vector<size_t> found, nearly;
  for (const size_t i : candidates) {
    const ColorFit fit = color_fit(term.color, color_of(objects, i));
    if (fit == ColorFit::kYes) found.push_back(i);
    if (fit == ColorFit::kNearly) nearly.push_back(i);
  }
  if (nearly.empty() && !found.empty()) return found;
  if (nearly.size() == 1 && found.empty()) return nearly;
  if (nearly.empty()) {
    throw_bad_input({}, "--select", "no object is \"" + what + "\": " + colors_of(objects, candidates),
                    did_you_mean(objects, candidates) + "`aligngs edit RUN --list` shows all objects");
  }
  found.insert(found.end(), nearly.begin(), nearly.end());
  throw_bad_input({}, "--select",
                  "\"" + what + "\" is not certain, since these have about this colour: " + objects.names(found),
                  did_you_mean(objects, found) + "Name them by their numbers");
}

std::vector<size_t> of_narrow_name(const RoomObjects& objects, const ObjectRelations& relations,
                                   const std::vector<size_t>& candidates, NarrowPlace place) {
  if (candidates.size() < 2) return candidates;
  std::vector<size_t> found;
  for (const size_t i : candidates) {
    if (stands(objects, relations, i, place)) found.push_back(i);
  }
  if (found.empty()) {
    throw_bad_input({}, "--select",
                    "none of these is " + std::string(narrow_place_words(place)) + ": " + objects.names(candidates),
                    did_you_mean(objects, candidates) + "Name them by their numbers");
  }
  return found;
}

}  // namespace aligngs
