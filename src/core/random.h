// A small seeded random generator whose whole state can be saved in a checkpoint.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace aligngs {

/// xoshiro256** (Blackman and Vigna 2018): the same numbers on every platform and compiler, unlike the
/// distributions of <random>.
class Random {
 public:
  explicit Random(uint64_t seed = 0);

  uint64_t next();
  double uniform();                         ///< in [0, 1)
  double uniform(double low, double high);  ///< in [low, high)
  double normal();                          ///< standard normal (Box-Muller, no cached second value)
  int below(int n);                         ///< in [0, n), n >= 1
  bool chance(double probability) { return uniform() < probability; }
  template <class T>
  void shuffle(std::vector<T>& values) {
    for (std::size_t i = values.size(); i > 1; --i) {
      std::swap(values[i - 1], values[static_cast<std::size_t>(below(static_cast<int>(i)))]);
    }
  }
  /// An independent generator for a named purpose, so that adding a draw in one place moves no other.
  Random fork(uint64_t purpose) const;

  const std::array<uint64_t, 4>& state() const { return state_; }
  void set_state(const std::array<uint64_t, 4>& state) { state_ = state; }

 private:
  std::array<uint64_t, 4> state_;
};

}  // namespace aligngs
