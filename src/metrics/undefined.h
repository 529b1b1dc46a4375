// The value of every measure that nothing was measured for.
#pragma once

#include <limits>

namespace aligngs {

/// Written as null in JSON and as a dash in tables.
inline constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

}  // namespace aligngs
