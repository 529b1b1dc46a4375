// Expected time of networks on this machine's processor.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "nn/compute.h"

namespace aligngs {

/// Operations per second (2 per multiply-add) that whole networks reach here: a share of the rate of large products.
/// Measures that rate, which takes about a quarter of a second.
double measure_network_rate(nn::Compute& compute);

/// Seconds of a model of the registry for `photos` at such a rate. Empty where its operations were not counted.
std::optional<double> network_seconds(const std::string& model, size_t photos, double rate);

}  // namespace aligngs
