// A pixel term: a loss that looks at one pixel alone, as the weighted mean over the pixels that take part. Its formula
// is a class template in a file of this folder, for host and device. The CPU rows (losses/pixel_rows.h) and the CUDA
// kernels (cuda/pixel_terms.cuh) fold over the list of them (pixel_terms.h).
//
//   template <class T>
//   struct SomeTerm {
//     static constexpr Loss kLoss;                   // its row of the catalogue, which says what it needs
//     explicit SomeTerm(const LossSettings&);
//     T weight(const TermPixel<T>&) const;           // of the pixel in the mean; 0 where it takes no part
//     TermValue<T> at(const TermPixel<T>&, T weight, T step) const;
//   };
//
// The body of a loop over pixels is to be vectorised: weight() and at() select plain values and have no branches.
#pragma once

#include <cstdint>

#include "core/always_inline.h"
#include "core/vec.h"
#include "engine/loss_catalogue.h"

namespace aligngs {

/// Inputs of a term at one pixel. Those that its row of the catalogue does not name have these values.
template <class T>
struct TermPixel {
  T depth{};                 ///< kNeedsDepth: plane depth, 0 = none
  uint8_t validity = 0;      ///< kNeedsDepth: DepthValidity
  Vec3<T> direction;         ///< kNeedsUnitNormal: N / |N|, zero = none
  T inverse_length{};        ///< kNeedsUnitNormal: 1 / |N|, 0 = none
  float prior_depth = 0;     ///< kNeedsPriorDepth: may be anything, as read from a file
  Vec3<float> prior_normal;  ///< kNeedsPriorNormal: the same
  float confidence = 1;      ///< of the prior: none unless in (0, 1]
};

template <class T>
struct TermValue {
  T value{};          ///< weight times the loss; 0 without a weight
  T by_depth{};       ///< step times its derivative by the plane depth; only with kNeedsDepth
  Vec3<T> by_normal;  ///< step times its derivative by the blended normal N; only with kNeedsUnitNormal
};

}  // namespace aligngs
