#include "synth/class_confusions.h"

#include <map>
#include <string>

#include "scene/label_set.h"

namespace aligngs {
namespace {

/// Judgement: pairs of classes that published segmentation networks confuse.
const std::map<std::string, std::vector<std::string>>& name_table() {
  static const std::map<std::string, std::vector<std::string>> kTable = {
      {"cabinet", {"wardrobe", "chest of drawers", "buffet"}},
      {"wardrobe", {"cabinet", "door", "chest of drawers"}},
      {"chest of drawers", {"cabinet", "desk", "wardrobe"}},
      {"bookcase", {"shelf", "cabinet"}},
      {"shelf", {"bookcase", "cabinet"}},
      {"table", {"desk", "coffee table"}},
      {"desk", {"table", "coffee table"}},
      {"coffee table", {"table", "desk"}},
      {"sofa", {"armchair", "seat", "bed"}},
      {"armchair", {"sofa", "chair"}},
      {"chair", {"armchair", "swivel chair"}},
      {"swivel chair", {"chair", "armchair"}},
      {"stool", {"chair", "table"}},
      {"ottoman", {"stool", "seat"}},
      {"bed", {"sofa", "blanket"}},
      {"pillow", {"cushion", "bed"}},
      {"cushion", {"pillow", "bed"}},
      {"blanket", {"bed", "cushion"}},
      {"painting", {"mirror", "windowpane", "poster"}},
      {"bulletin board", {"painting", "poster"}},
      {"windowpane", {"painting", "mirror", "blind"}},
      {"curtain", {"blind", "windowpane"}},
      {"door", {"wardrobe", "cabinet", "screen door"}},
      {"rug", {"floor", "floor", "blanket"}},
      {"lamp", {"light", "sconce"}},
      {"light", {"lamp", "chandelier"}},
      {"chandelier", {"light", "lamp"}},
      {"television", {"monitor", "screen", "painting"}},
      {"monitor", {"television", "computer"}},
      {"computer", {"monitor", "book"}},
      {"radiator", {"blind", "railing"}},
      {"plant", {"flower", "tree"}},
      {"pot", {"vase", "basket"}},
      {"vase", {"pot", "bottle"}},
      {"bottle", {"vase", "glass"}},
      {"glass", {"vase", "plate"}},
      {"plate", {"tray", "food"}},
      {"book", {"box", "bookcase"}},
      {"box", {"basket", "case"}},
      {"basket", {"box", "bag"}},
      {"ashcan", {"pot", "basket"}},
      {"clock", {"painting", "plate"}},
      {"countertop", {"counter", "table"}},
      {"stove", {"oven", "cabinet"}},
      {"oven", {"stove", "dishwasher"}},
      {"microwave", {"oven", "television"}},
      {"refrigerator", {"cabinet", "wardrobe"}},
      {"sink", {"countertop", "counter"}},
      {"hood", {"cabinet", "shelf"}},
  };
  return kTable;
}

}  // namespace

std::vector<uint16_t> confusable_classes(uint16_t label) {
  const LabelSet& labels = ade20k_labels();
  std::vector<uint16_t> out;
  if (label >= labels.size()) return out;
  const auto entry = name_table().find(labels.classes[label].name);
  if (entry == name_table().end()) return out;
  for (const std::string& name : entry->second) {
    const int index = labels.find(name);
    if (index >= 0) out.push_back(static_cast<uint16_t>(index));
  }
  return out;
}

bool is_stuff(uint16_t label) {
  static const uint16_t kStuff[] = {static_cast<uint16_t>(ade20k_labels().find("wall")),
                                    static_cast<uint16_t>(ade20k_labels().find("floor")),
                                    static_cast<uint16_t>(ade20k_labels().find("ceiling"))};
  return label == kStuff[0] || label == kStuff[1] || label == kStuff[2];
}

}  // namespace aligngs
