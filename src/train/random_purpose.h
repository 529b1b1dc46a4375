// The random generators of a run: each purpose has one of its own, so that a draw more in one place moves no other.
#pragma once

#include <cstdint>

#include "core/random.h"

namespace aligngs {

/// The numbers are part of the result of a seed and never change; a new purpose takes a new one.
enum class RandomPurpose : uint64_t {
  kViewOrder = 1,
  kDensity = 2,     ///< draws of density control
  kStart = 3,       ///< the points of a random start
  kBackground = 4,  ///< of a step
  kNeighbour = 5,   ///< of a step, and the pixels of its photometric term
  kDropout = 6,     ///< Gaussians that a step leaves out
  kNoise = 7        ///< on positions, after a step
};

inline Random random_of(uint64_t run_seed, RandomPurpose purpose) {
  return Random(run_seed).fork(static_cast<uint64_t>(purpose));
}

}  // namespace aligngs
