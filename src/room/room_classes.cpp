#include "room/room_classes.h"

namespace aligngs {
namespace {

constexpr const char* kFurniture[] = {
    "bed",       "cradle",       "sofa",       "chair",      "armchair",       "swivel chair",
    "stool",     "ottoman",      "bench",      "seat",       "table",          "coffee table",
    "desk",      "pool table",   "counter",    "countertop", "kitchen island", "bar",
    "buffet",    "cabinet",      "wardrobe",   "bookcase",   "shelf",          "chest of drawers",
    "case",      "refrigerator", "stove",      "oven",       "microwave",      "dishwasher",
    "washer",    "hood",         "sink",       "bathtub",    "toilet",         "shower",
    "fireplace", "radiator",     "television", "crt screen", "screen",         "monitor",
    "computer",  "lamp",         "plant",      "basket",     "ashcan",         "arcade machine",
    "column"};

}  // namespace

std::vector<RoomClass> room_classes(const LabelSet& labels) {
  std::vector<RoomClass> out(labels.classes.size());
  const auto of = [&](const char* name, auto&& set) {
    const int index = labels.find(name);
    if (index >= 0) set(out[static_cast<size_t>(index)]);
  };
  for (const char* name : kFurniture) of(name, [](RoomClass& c) { c.furniture = true; });
  of("plant", [](RoomClass& c) { c.leafy = true; });
  of("wall", [](RoomClass& c) { c.wall = true; });
  for (const char* name : {"floor", "rug"}) of(name, [](RoomClass& c) { c.floor = true; });
  of("ceiling", [](RoomClass& c) { c.ceiling = true; });
  for (const char* name : {"door", "screen door"}) of(name, [](RoomClass& c) { c.opening = OpeningKind::kDoor; });
  of("windowpane", [](RoomClass& c) {
    c.opening = OpeningKind::kWindow;
    c.glass = true;
  });
  for (const char* name : {"painting", "poster", "bulletin board"})
    of(name, [](RoomClass& c) { c.opening = OpeningKind::kPicture; });
  of("beyond a wall", [](RoomClass& c) { c.glass = true; });
  of("mirror", [](RoomClass& c) {
    c.opening = OpeningKind::kMirror;
    c.glass = true;
  });
  return out;
}

}  // namespace aligngs
