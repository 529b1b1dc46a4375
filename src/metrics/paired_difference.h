// Is B better than A? Differences of pairs measured under the same conditions, with an interval.
#pragma once

#include <cstddef>
#include <vector>

namespace aligngs {

/// No interval of fewer pairs says how much the mean would move with others.
inline constexpr size_t kFewestPairs = 3;

struct PairedDifference {
  size_t pairs = 0;          ///< pairs in which both are numbers
  double mean = 0;           ///< of b - a; NaN without pairs
  double low = 0, high = 0;  ///< 95 % interval of the mean; NaN for fewer than kFewestPairs

  bool has_interval() const { return pairs >= kFewestPairs; }
  /// The interval has pairs enough to mean something and lies on one side of zero.
  bool beyond_noise() const { return has_interval() && (low > 0 || high < 0); }
};

/// Percentile bootstrap (Efron 1979) over the pairs, 10 000 draws with a fixed seed: the same pairs give the same
/// interval.
/// `a` and `b` have equal length; pairs with a NaN are left out.
PairedDifference paired_difference(const std::vector<double>& a, const std::vector<double>& b);

}  // namespace aligngs
