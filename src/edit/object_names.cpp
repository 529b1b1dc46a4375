#include "edit/object_names.h"

#include <algorithm>

namespace aligngs {
namespace {

constexpr size_t kShownObjects = 8;  // more fill the screen

std::string joined(const std::vector<Instance>& objects, size_t count, const LabelSet& labels) {
  std::string text;
  for (size_t i = 0; i < count; ++i) text += (i ? ", " : "") + object_name(objects[i], labels);
  return text;
}

}  // namespace

std::string object_name(const Instance& object, const LabelSet& labels) {
  return labels.classes.at(static_cast<size_t>(object.label)).name + "#" + std::to_string(object.number);
}

std::string objects_text(const std::vector<Instance>& objects, const LabelSet& labels) {
  return objects.empty() ? "nothing that has a name" : joined(objects, objects.size(), labels);
}

std::string first_objects_text(const std::vector<Instance>& objects, const LabelSet& labels) {
  std::string text = joined(objects, std::min(objects.size(), kShownObjects), labels);
  if (objects.size() > kShownObjects) text += " and " + std::to_string(objects.size() - kShownObjects) + " more";
  return text;
}

}  // namespace aligngs
