// Weights in memory for tests.
#pragma once

#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/random.h"
#include "io/weight_file.h"
#include "nn/random_weights.h"

namespace aligngs::nn {

class MemoryWeights : public WeightFile {
 public:
  MemoryWeights() : WeightFile("weights.test") {}

  void set(const std::string& name, const std::vector<int64_t>& shape, std::vector<float> values) {
    tensors_[name] = {"F32", shape};
    values_[name] = std::move(values);
  }
  void forget(const std::string& name) { tensors_.erase(name); }
  std::vector<float> read(const std::string& name) const override { return values_.at(name); }

  /// Small random values for all tensors of a list.
  static std::shared_ptr<MemoryWeights> random(const TensorList& tensors, uint64_t seed = 1) {
    auto file = std::make_shared<MemoryWeights>();
    Random random(seed);
    for (const SafetensorsStream::Entry& tensor : tensors) {
      size_t count = 1, inputs = 1;
      for (size_t i = 0; i < tensor.shape.size(); ++i) {
        count *= size_t(tensor.shape[i]);
        if (i > 0) inputs *= size_t(tensor.shape[i]);
      }
      std::vector<float> values(count);
      const bool positive = tensor.name.find("running_var") != std::string::npos;
      for (float& v : values) {
        v = float(random.normal()) / std::sqrt(float(inputs));
        if (positive) v = 0.5f + v * v;
      }
      file->set(tensor.name, tensor.shape, std::move(values));
    }
    return file;
  }

 private:
  std::map<std::string, std::vector<float>> values_;
};

inline std::vector<float> random_values(size_t count, uint64_t seed = 1) {
  std::vector<float> values(count);
  Random random(seed);
  for (float& v : values) v = float(random.normal());
  return values;
}

}  // namespace aligngs::nn
