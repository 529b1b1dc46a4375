#include "scene/ignored_classes.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

#include "core/error.h"
#include "scene/semantic_target.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

std::string trimmed(const std::string& text) {
  const size_t begin = text.find_first_not_of(" \t"), end = text.find_last_not_of(" \t");
  return begin == std::string::npos ? std::string() : text.substr(begin, end - begin + 1);
}

/// Words for what moves that label sets do not have: each with the class that holds it in ADE20K.
int class_of_word(const LabelSet& labels, const std::string& word) {
  if (const int found = labels.find(word); found >= 0) return found;
  static const std::map<std::string, const char*> kWords = {
      {"people", "person"}, {"persons", "person"}, {"human", "person"}, {"man", "person"},    {"woman", "person"},
      {"child", "person"},  {"baby", "person"},    {"cat", "animal"},   {"cats", "animal"},   {"dog", "animal"},
      {"dogs", "animal"},   {"pet", "animal"},     {"pets", "animal"},  {"animals", "animal"}};
  std::string lower = word;
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const auto known = kWords.find(lower);
  return known == kWords.end() ? -1 : labels.find(known->second);
}

/// Sets regions (neighbours along the axes) of fewer than `least` marked pixels to 0.
void drop_small(Image<uint8_t>& marked, size_t least) {
  Image<uint8_t> seen(marked.width, marked.height, 1);
  std::vector<std::pair<int, int>> region;
  for (int y = 0; y < marked.height; ++y) {
    for (int x = 0; x < marked.width; ++x) {
      if (!marked.at(x, y) || seen.at(x, y)) continue;
      region.assign(1, {x, y});
      seen.at(x, y) = 1;
      for (size_t i = 0; i < region.size(); ++i) {
        const auto [cx, cy] = region[i];
        for (const auto& [nx, ny] : {std::pair{cx - 1, cy}, {cx + 1, cy}, {cx, cy - 1}, {cx, cy + 1}}) {
          if (nx < 0 || ny < 0 || nx >= marked.width || ny >= marked.height || !marked.at(nx, ny) || seen.at(nx, ny))
            continue;
          seen.at(nx, ny) = 1;
          region.push_back({nx, ny});
        }
      }
      if (region.size() >= least) continue;
      for (const auto& [rx, ry] : region) marked.at(rx, ry) = 0;
    }
  }
}

/// Marks what lies within `reach` pixels of a marked one, in each direction.
Image<uint8_t> grown(const Image<uint8_t>& marked, int reach) {
  Image<uint8_t> wide(marked.width, marked.height, 1), out(marked.width, marked.height, 1);
  for (int y = 0; y < marked.height; ++y) {
    for (int x = 0; x < marked.width; ++x) {
      if (!marked.at(x, y)) continue;
      for (int i = std::max(0, x - reach); i <= std::min(marked.width - 1, x + reach); ++i) wide.at(i, y) = 1;
    }
  }
  for (int y = 0; y < marked.height; ++y) {
    for (int x = 0; x < marked.width; ++x) {
      if (!wide.at(x, y)) continue;
      for (int i = std::max(0, y - reach); i <= std::min(marked.height - 1, y + reach); ++i) out.at(x, i) = 1;
    }
  }
  return out;
}

}  // namespace

std::vector<int> ignored_classes(const LabelSet& labels, const std::string& list) {
  std::vector<int> classes;
  for (size_t begin = 0; begin <= list.size();) {
    const size_t end = std::min(list.find(',', begin), list.size());
    const std::string name = trimmed(list.substr(begin, end - begin));
    begin = end + 1;
    if (name.empty()) continue;
    const int found = class_of_word(labels, name);
    if (found >= 0) {
      classes.push_back(found);
    } else if (trimmed(list) != kIgnoredByDefault) {
      throw_usage("'" + name + "' is no class of " + labels.name,
                  "name classes to ignore, e.g. person, cat, dog; docs/photos.md tells more");
    }
  }
  std::sort(classes.begin(), classes.end());
  classes.erase(std::unique(classes.begin(), classes.end()), classes.end());
  return classes;
}

Image<uint8_t> mask_without(const Image<uint16_t>& labels, const std::vector<int>& classes,
                            const IgnoredRegionOptions& options) {
  const int width = labels.width, height = labels.height;
  Image<uint8_t> mask(width, height, 1, 255), marked(width, height, 1);
  bool any = false;
  for (size_t i = 0; i < labels.data.size(); ++i) {
    if (labels.data[i] == kNoLabel || !std::binary_search(classes.begin(), classes.end(), int(labels.data[i])))
      continue;
    marked.data[i] = 1;
    any = true;
  }
  if (!any) return mask;
  drop_small(marked, std::max<size_t>(1, size_t(std::ceil(options.least_share * double(marked.pixels())))));
  marked = grown(marked, int(std::lround(options.border * std::max(width, height))));
  for (size_t i = 0; i < mask.data.size(); ++i) {
    if (marked.data[i]) mask.data[i] = 0;
  }
  return mask;
}

}  // namespace aligngs
