// Upwards in a file of splats, as a person says it.
#pragma once

#include <string>

#include "core/choice_words.h"
#include "core/vec.h"

namespace aligngs {

enum class UpAxis { kX, kY, kZ, kMinusX, kMinusY, kMinusZ };
template <>
inline constexpr std::array<ChoiceWord<UpAxis>, 6> kChoiceWords<UpAxis> = {{{UpAxis::kX, "x"},
                                                                            {UpAxis::kY, "y"},
                                                                            {UpAxis::kZ, "z"},
                                                                            {UpAxis::kMinusX, "-x"},
                                                                            {UpAxis::kMinusY, "-y"},
                                                                            {UpAxis::kMinusZ, "-z"}}};

/// The axis of "x", "y", "z", "-x", "-y" or "-z"; Error{kUsage} for other words.
UpAxis parse_axis(const std::string& text);

/// Unit.
Vec3d direction_of(UpAxis axis);

}  // namespace aligngs
