// From a teacher's numbers to class probabilities, and from probabilities to labels.
#pragma once

#include "core/image.h"
#include "scene/view_data.h"

namespace aligngs {

struct SemanticConversion {
  SemanticKind kind = SemanticKind::kLogits;
  double score_gamma = 1;  ///< exponent of positive scores
  double least_score_sum = kUnknownScoreSum;
};

/// Converts values[C][height][width]. Logits: softmax. Scores: max(s, 0)^gamma / sum, confidence 0 where sum of max(s,
/// 0) < least_score_sum. Probabilities: normalised to sum 1, confidence 0 where they sum to less. Pixels with a value
/// that is not finite and pixels without any positive value get uniform probabilities and confidence 0.
SemanticTarget semantic_target(const float* values, int channels, int width, int height,
                               const SemanticConversion& conversion);

/// Sets target.scale from the numbers that the target holds; 1 where they sum to 0 or to a number that is not finite.
void normalise_target(SemanticTarget& target);

/// Arg-max of the probabilities, interpolated bilinearly at pixel centres to width x height and weighted by
/// confidence; kNoLabel where the interpolated confidence is below 0.5. Ties go to the lower class.
Image<uint16_t> target_labels(const SemanticTarget& target, int width, int height);

}  // namespace aligngs
