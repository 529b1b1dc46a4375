// Limits within which a step of the optimiser keeps finite numbers finite, for every engine.
#pragma once

#include "engine/settings.h"

namespace aligngs {

/// Gradients beyond this count as non-finite. Within it a step keeps finite numbers finite, given 0 <= beta < 1,
/// epsilon >= 1e-20 and a rate <= 1e4. The second moment stays below 1e34 and |m| / sqrt(v) is bounded, so a parameter
/// moves by some ten times its rate at most. Hence checking the gradients suffices, and nothing has to be rolled back.
inline constexpr float kGradientLimit = 1e17f;

/// Throws Error{kUsage} when a rate, a beta or epsilon is outside the limits above.
void check_optimiser_settings(const StepRequest& request);

}  // namespace aligngs
