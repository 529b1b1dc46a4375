// Gaussians as columns of small numbers, for what the page unpacks in one piece (web/src/packed_scene.ts).
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "gaussians/gaussian_model.h"
#include "gaussians/gaussian_ply.h"

namespace aligngs {

/// Columns of some rows of a model behind each other, with their description. Both arguments outlive it.
class SplatColumns {
 public:
  SplatColumns(const GaussianModel& model, const std::vector<uint32_t>& rows) : model_(model), rows_(rows) {}

  void add_positions();  ///< x y z: float32, scene units
  /// f_dc_0..2, and the first `harmonics` of f_rest_*, channel-major; a multiple of 3
  void add_colors(size_t harmonics);
  /// opacity: logit; scale_0..2: natural logarithms; rot_0..3: unit quaternion w x y z
  void add_shapes();
  void add_labels(const GaussianLabels& labels);  ///< label, instance, confidence

  /// [{"name", "type", "step"}...]: a value is the stored number times the step.
  const nlohmann::ordered_json& description() const { return description_; }
  const std::string& data() const { return data_; }  ///< little-endian

 private:
  template <class Number, class Value>
  void add(const std::string& name, const char* type, float step, const Value& value);

  const GaussianModel& model_;
  const std::vector<uint32_t>& rows_;
  nlohmann::ordered_json description_ = nlohmann::ordered_json::array();
  std::string data_;
};

}  // namespace aligngs
