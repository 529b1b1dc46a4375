#include "priors/network_time.h"

#include "nn/matrix_rate.h"
#include "priors/model_sets.h"

namespace aligngs {

double measure_network_rate(nn::Compute& compute) {
  constexpr double kShareOfRate = 0.6;  // measured in benchmarks/README.md
  return nn::measure_matrix_rate(compute) * kShareOfRate;
}

std::optional<double> network_seconds(const std::string& model, size_t photos, double rate) {
  const double operations = 1e12 * tera_operations_per_photo(model);
  if (!(operations > 0) || !(rate > 0)) return std::nullopt;
  return operations * static_cast<double>(photos) / rate;
}

}  // namespace aligngs
