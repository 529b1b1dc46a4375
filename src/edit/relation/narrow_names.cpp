#include "edit/relation/narrow_names.h"

#include <string>
#include <utility>

#include "edit/vocabulary.h"

namespace aligngs {
namespace {

constexpr std::pair<std::string_view, NarrowPlace> kNames[] = {
    {"floor lamp", NarrowPlace::kOnFloor},    {"standing lamp", NarrowPlace::kOnFloor},
    {"standard lamp", NarrowPlace::kOnFloor}, {"table lamp", NarrowPlace::kOnFurniture},
    {"desk lamp", NarrowPlace::kOnFurniture}, {"bedside lamp", NarrowPlace::kAtBed},
    {"bedside table", NarrowPlace::kAtBed},   {"bedside cabinet", NarrowPlace::kAtBed},
    {"nightstand", NarrowPlace::kAtBed},      {"night stand", NarrowPlace::kAtBed},
    {"night table", NarrowPlace::kAtBed},     {"bedside rug", NarrowPlace::kAtBed},
    {"bedside clock", NarrowPlace::kAtBed}};

}  // namespace

NarrowPlace narrow_place(std::string_view words) {
  const std::string folded = without_article(folded_name(words));
  for (const auto& [name, place] : kNames) {
    if (folded == name || folded == std::string(name) + "s") return place;
  }
  return NarrowPlace::kNone;
}

std::string_view narrow_place_words(NarrowPlace place) {
  if (place == NarrowPlace::kOnFloor) return "on the floor";
  return place == NarrowPlace::kOnFurniture ? "on furniture" : "beside a bed";
}

}  // namespace aligngs
