// Operations on the arrays of an engine's state, alike for all engines: names in checkpoints, shapes, checks of
// requests.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/engine.h"
#include "engine/formulas/semantic_loss.h"

namespace aligngs {

struct NamedArray {
  const char* name;
  std::vector<float>* values;
  size_t width;  ///< numbers per row
};
std::vector<NamedArray> arrays_of(GaussianModel& model);
std::vector<NamedArray> arrays_of(DensityStatistics& statistics);

/// Throws Error{kFailed} when an array does not have the model's number of rows, Error{kResources} beyond 2^32 rows.
void check_model(const GaussianModel& model);

/// Throws Error{kFailed} for a view that does not exist and Error{kUsage} for a degree or extent out of range.
void check_step_request(const StepRequest& request, size_t views);

/// The name of the first loss that is not finite, or nullptr.
const char* non_finite_loss(const LossTerms& terms);

/// Throws Error{kFailed} when the plan names a row that the model has not.
void check_plan(const RestructurePlan& plan, size_t rows);

/// Natural logarithm of the odds of a reset opacity. Throws Error{kUsage} outside (0, 1).
float reset_logit(float maximum);

/// Throws Error{kFailed} unless there is one number per row.
void check_floors(const std::vector<float>& log_floors, size_t rows);

/// Adam's running moments, arrays as in the model.
struct AdamMoments {
  GaussianModel m, v;
  std::vector<float> semantic_updates;  ///< [N] of each semantic row so far, which the bias correction counts
  /// Spherical harmonics beyond this many numbers per row have zero moments and, so far, no gradient.
  size_t sh_used = 3;

  void reset(const GaussianModel& like);  ///< to zeros
};

/// The content of a checkpoint beside the model, with all classes.
struct EngineMemory {
  AdamMoments moments;  ///< of a program that did not count the updates: more of them than any step
  DensityStatistics statistics;
  CouplingBalance balance;
};
/// The running values of the coupling are kept bit for bit: rounded ones would make a resumed run differ.
void pack_state(GaussianModel model, EngineMemory memory, EngineState& state);
/// Throws Error{kBadInput} naming the array that is absent or has another length.
EngineMemory unpack_state(const EngineState& state);

}  // namespace aligngs
