#include "edit/fill/carrying_classes.h"

namespace aligngs {
namespace {

/// Furniture with a top, a seat or a back that other things touch.
constexpr const char* kFurniture[] = {"bed",
                                      "sofa",
                                      "chair",
                                      "armchair",
                                      "swivel chair",
                                      "stool",
                                      "ottoman",
                                      "bench",
                                      "seat",
                                      "table",
                                      "coffee table",
                                      "desk",
                                      "counter",
                                      "countertop",
                                      "pool table",
                                      "kitchen island",
                                      "bar",
                                      "buffet",
                                      "cabinet",
                                      "wardrobe",
                                      "bookcase",
                                      "shelf",
                                      "chest of drawers",
                                      "case",
                                      "refrigerator",
                                      "stove",
                                      "washer",
                                      "dishwasher",
                                      "fireplace",
                                      "box",
                                      "stage",
                                      "stairs",
                                      "step",
                                      "base"};

}  // namespace

std::vector<CarryingClass> carrying_classes(const LabelSet& labels) {
  std::vector<CarryingClass> out(labels.classes.size());
  const auto of = [&](const char* name, auto&& set) {
    const int index = labels.find(name);
    if (index >= 0) set(out[static_cast<size_t>(index)]);
  };
  for (const char* name : kFurniture) of(name, [](CarryingClass& c) { c.furniture = true; });
  of("wall", [](CarryingClass& c) { c.shell = PlaneKind::kWall; });
  of("floor", [](CarryingClass& c) { c.shell = PlaneKind::kFloor; });
  of("ceiling", [](CarryingClass& c) { c.shell = PlaneKind::kCeiling; });
  of("rug", [](CarryingClass& c) { c.on_floor = true; });
  return out;
}

}  // namespace aligngs
