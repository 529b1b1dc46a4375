#include "priors/model_sets.h"

#include <algorithm>
#include <map>

#include "core/error.h"

namespace aligngs {

const std::vector<ModelSet>& model_sets() {
  static const std::vector<ModelSet> sets = {
      {"light", "the smallest: cameras, depth and classes", {"da3-small", "lingbot-s"}},
      {"recommended", "cameras and depth in metres, and good classes", {"da3-base", "da3metric-large", "eomt-l"}},
      {"paper", "the networks of the paper, of which one is non-commercial", {"vggt-1b", "ade20k-m2f", "nyu-dpt-l"}},
  };
  return sets;
}

const ModelSet* find_model_set(const std::string& name) {
  for (const ModelSet& set : model_sets()) {
    if (set.name == name) return &set;
  }
  return nullptr;
}

std::vector<const PublishedModel*> models_of(const std::vector<std::string>& names) {
  std::vector<const PublishedModel*> wanted;
  const auto add = [&](const std::string& name) {
    for (const PublishedModel* model : with_needs(published_model(name))) {
      if (std::find(wanted.begin(), wanted.end(), model) == wanted.end()) wanted.push_back(model);
    }
  };
  for (const std::string& name : names) {
    if (const ModelSet* set = find_model_set(name))
      std::for_each(set->models.begin(), set->models.end(), add);
    else
      add(name);
  }
  return wanted;
}

double tera_operations_per_photo(const std::string& model) {
  static const std::map<std::string, double> counted = {
      {"vggt-1b", 4.7},          {"vggt-1b-commercial", 4.7}, {"lingbot-map", 4.7},      {"da3-small", 0.18},
      {"da3-base", 0.48},        {"da3metric-large", 0.90},   {"ade20k-m2f", 45.6},      {"eomt-l", 1.58},
      {"eomt-l-panoptic", 4.01}, {"lingbot-s", 0.064},        {"ade20k-linear-s", 0.19}, {"ade20k-linear-b", 0.61},
      {"ade20k-linear-l", 2.0},  {"ade20k-linear-g", 7.2},    {"nyu-dpt-l", 1.5},        {"nyu-dpt-g", 4.7},
  };
  const auto found = counted.find(model);
  return found == counted.end() ? 0 : found->second;
}

}  // namespace aligngs
