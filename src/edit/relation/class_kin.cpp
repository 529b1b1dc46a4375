#include "edit/relation/class_kin.h"

#include <algorithm>
#include <string_view>
#include <vector>

namespace aligngs {
namespace {

const std::vector<std::vector<std::string_view>>& kin() {
  static const std::vector<std::vector<std::string_view>> kKin = {
      {"chair", "armchair", "swivel chair", "seat", "stool", "bench", "sofa"},
      {"stool", "ottoman", "cushion"},
      {"sofa", "bed", "cradle", "bench"},
      {"lamp", "light", "sconce", "chandelier", "streetlight"},
      {"cabinet", "chest of drawers", "wardrobe", "buffet", "shelf", "bookcase", "case", "counter"},
      {"table", "coffee table", "desk", "pool table", "kitchen island", "counter", "countertop", "stool"},
      {"painting", "poster", "mirror", "bulletin board", "signboard", "screen"},
      {"pillow", "cushion", "blanket"},
      {"blanket", "rug", "towel", "apparel"},
      {"curtain", "blind", "awning", "canopy"},
      {"television", "monitor", "crt screen", "screen", "computer"},
      {"plant", "flower", "tree", "palm", "grass", "pot", "vase"},
      {"box", "basket", "bag", "ashcan", "case", "barrel"},
      {"bottle", "glass", "vase", "pot", "plate", "tray"},
      {"door", "screen door"},
      {"stairs", "stairway", "step", "escalator"},
      {"railing", "bannister", "fence"},
      {"stove", "oven", "microwave", "hood"},
      {"washer", "dishwasher", "refrigerator", "oven"},
      {"sink", "bathtub", "shower", "toilet"},
      {"sculpture", "plaything", "vase"},
      {"windowpane", "door", "curtain", "blind"}};
  return kKin;
}

}  // namespace

bool are_kin(const LabelSet& labels, int label, int other) {
  if (label < 0 || other < 0 || label == other) return false;
  const std::string_view a = labels.classes.at(static_cast<size_t>(label)).name,
                         b = labels.classes.at(static_cast<size_t>(other)).name;
  return std::any_of(kin().begin(), kin().end(), [&](const std::vector<std::string_view>& family) {
    return std::find(family.begin(), family.end(), a) != family.end() &&
           std::find(family.begin(), family.end(), b) != family.end();
  });
}

}  // namespace aligngs
