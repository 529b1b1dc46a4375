// Number formats of the networks' matrix products.
#pragma once

#include <cstdint>

#include "core/choice_words.h"

namespace aligngs {
namespace nn {

/// Precision of the operands of matrix products and of attention. Sums, normalisations and the residual stream are
/// float32 in each.
enum class Precision {
  kFloat32,
  kBfloat16,
  kFloat16  ///< weights alone; what they are multiplied with and attention are float32. Not for devices.
};

/// Bytes of a weight of a matrix, and of a number that it is multiplied with.
constexpr uint64_t bytes_of_weight(Precision precision) { return precision == Precision::kFloat32 ? 4 : 2; }
constexpr uint64_t bytes_of_operand(Precision precision) { return precision == Precision::kBfloat16 ? 2 : 4; }

}  // namespace nn

template <>
inline constexpr std::array<ChoiceWord<nn::Precision>, 3> kChoiceWords<nn::Precision> = {
    {{nn::Precision::kFloat32, "float32"},
     {nn::Precision::kBfloat16, "bfloat16"},
     {nn::Precision::kFloat16, "float16"}}};

}  // namespace aligngs
