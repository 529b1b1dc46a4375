// The pieces of semantic_loss.h that belong to one channel, for engines that spread a pixel's channels over lanes. A
// channel represents `count` classes of equal probability (engine/shared/active_classes.h): 1, or n for the remainder.
// With count == 1 everywhere they are exactly the terms of semantic_loss.h.
#pragma once

#include "core/host_device.h"

namespace aligngs {

/// kProbabilities at one channel.
template <class T>
struct ProbabilityChannel {
  T q{};         ///< probability inside the logarithm: max(B + count (1 - A) / C, count floor)
  bool above{};  ///< not at the floor: it has a gradient
};

/// `rest` = (1 - A) / C with C all classes, `floor` = semantic_floor(C).
template <class T>
ALIGNGS_HD inline ProbabilityChannel<T> probability_channel(T blended, T rest, T count, T floor) {
  const T q = blended + rest * count, low = floor * count;
  const bool above = !(q <= low);  // what is not a number stays so, for the loss to show it
  return {above ? q : low, above};
}

/// Row gradient g of a class with teacher probability `teacher`; `hard` is the hard weight at the arg-max, else 0.
template <class T>
ALIGNGS_HD inline T probability_gradient(const ProbabilityChannel<T>& channel, T teacher, T soft, T hard) {
  return channel.above ? -(soft * teacher + hard) / channel.q : T(0);
}

/// Coupling direction of bounded_coupling_probabilities. The difference of the remainder is spread over its classes:
/// their squares add up to its square / count.
template <class T>
ALIGNGS_HD inline T bounded_probability_direction(T blended, T inverse_alpha, T teacher, T omega, T count) {
  return omega * inverse_alpha * (blended * inverse_alpha - teacher) / count;
}

/// kLogits: row gradient of a channel with student probability q; `mass` = sum of the teacher, `hard_top` as above.
template <class T>
ALIGNGS_HD inline T logit_gradient(T q, T teacher, T mass, T soft, T hard, T hard_top) {
  return (soft * mass + hard) * q - soft * teacher - hard_top;
}

/// (q - t) / count of bounded_coupling_logits, and the direction from it and along = sum of q times it.
template <class T>
ALIGNGS_HD inline T bounded_logit_error(T q, T teacher, T count) {
  return (q - teacher) / count;
}
template <class T>
ALIGNGS_HD inline T bounded_logit_direction(T q, T error, T along, T omega) {
  return omega * q * (error - along);
}

}  // namespace aligngs
