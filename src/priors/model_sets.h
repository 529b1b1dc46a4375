// Named sets of weights that go together, for people who do not want to choose one by one.
#pragma once

#include <string>
#include <vector>

#include "priors/model_registry.h"

namespace aligngs {

struct ModelSet {
  std::string name;     ///< "light", "recommended", "paper"
  std::string purpose;  ///< one line
  std::vector<std::string> models;
};

const std::vector<ModelSet>& model_sets();

/// Null when there is no set of this name.
const ModelSet* find_model_set(const std::string& name);

/// Names of models and sets to models with what they need, each once, in order. Error{kUsage} for an unknown name.
std::vector<const PublishedModel*> models_of(const std::vector<std::string>& names);

/// Operations of one photo (2 per multiply-add), 10^12: a 4:3 photo of a set of 20, in windows where the network has
/// them. 0: of no network that is run on photos one by one or together. Source: counted from the published structures.
double tera_operations_per_photo(const std::string& model);

}  // namespace aligngs
