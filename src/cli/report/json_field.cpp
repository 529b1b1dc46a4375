#include "cli/report/json_field.h"

#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

namespace aligngs {

double number_at(const nlohmann::json& root, const std::string& dotted) {
  const nlohmann::json* node = &root;
  std::istringstream parts(dotted);
  for (std::string part; std::getline(parts, part, '.');) {
    if (!node->is_object() || !node->contains(part)) return std::numeric_limits<double>::quiet_NaN();
    node = &(*node)[part];
  }
  return node->is_number() ? node->get<double>() : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace aligngs
