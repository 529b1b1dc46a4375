// Classes that no teacher ranks high are carried as one: a room shows 20 to 50 of 150 classes.
//
// A class is active when some pixel of some view ranks it among its top k. The others become one last channel, the
// remainder, which represents n classes of equal probability. Its row number r means n equal logits r, and its teacher
// is the sum of theirs. With equal teachers among the n, losses and gradients are exactly those of all classes. Unequal
// teachers cost the term sum t_c log(t_c / mean t) over the n, which training cannot act on. The remainder takes part
// in no arg-max.
//
// Files and callers always see all classes: expanding repeats r, compressing takes it back bit by bit.
//
// Teachers are kept at their native resolution in float16 of the channels. With 45 of 150 classes active they are
// smaller than 8-bit log-probabilities of all classes. Their error is below 1e-6 nats and 2^-12 of a probability. 8-bit
// log-probabilities cost 9e-5 nats and 1.2 %, the sixteen best classes alone 4e-2 nats (teacher_storage_test.cpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/thread_pool.h"
#include "engine/training_view.h"

namespace aligngs {

struct ActiveClasses {
  int classes = 0;               ///< of the label set, C
  std::vector<uint16_t> active;  ///< ascending; with a remainder only
  bool has_remainder() const { return !active.empty(); }
  int remainder() const { return has_remainder() ? classes - static_cast<int>(active.size()) : 0; }
  /// Channels of the model that trains: the active classes, then the remainder; or all classes.
  int channels() const { return has_remainder() ? static_cast<int>(active.size()) + 1 : classes; }
};

/// `top_k` <= 0, fewer than two inactive classes, or views without semantics or with different numbers of classes: all
/// classes are channels. Only probabilities > 0 at pixels whose confidence is > 0 count.
ActiveClasses find_active_classes(const std::vector<TrainingView>& views, int top_k, ThreadPool& pool);

/// Replaces the target's C probabilities per pixel by those of the channels.
void compress_target(const ActiveClasses& map, ThreadPool& pool, SemanticTarget& target);

enum class RowKind {
  kLogits,  ///< n exp(r) = sum exp(s_c) over the remainder's classes
  kMoments  ///< the mean of theirs
};
/// Rows of C numbers to rows of map.channels(). Equal numbers of the remainder's classes are taken as they are.
std::vector<float> compress_rows(const ActiveClasses& map, RowKind kind, const std::vector<float>& rows);
/// The other way: every class of the remainder receives its number.
std::vector<float> expand_rows(const ActiveClasses& map, const std::vector<float>& rows);

}  // namespace aligngs
