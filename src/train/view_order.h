// The order in which training views are drawn.
#pragma once

#include <cstdint>
#include <vector>

#include "core/random.h"

namespace aligngs {

/// Draws without replacement: every view once per epoch, each epoch in a new random order. The whole state
/// is in state(), so a resumed run draws what the uninterrupted one would have drawn.
class ViewOrder {
 public:
  struct State {
    std::vector<int> left;  ///< views still to come in this epoch, last first
    std::array<uint64_t, 4> random{};
  };

  /// views >= 1.
  ViewOrder(int views, uint64_t seed);

  int next();
  State state() const { return {left_, random_.state()}; }
  /// Error{kBadInput} when the state names a view that does not exist.
  void set_state(const State& state);

 private:
  int views_;
  std::vector<int> left_;
  Random random_;
};

}  // namespace aligngs
