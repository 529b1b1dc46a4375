// The list of pixel terms, over which engines fold.
#pragma once

#include <cstddef>

#include "engine/losses/terms/log_depth.h"
#include "engine/losses/terms/prior_normal.h"

/// USE(Term) for every pixel term, in the order of the catalogue.
#define ALIGNGS_PIXEL_TERMS(USE) \
  USE(LogDepthTerm)              \
  USE(PriorNormalTerm)

namespace aligngs {

template <int, template <class> class... Terms>
struct PixelTermList {
  static constexpr size_t kCount = sizeof...(Terms);
};
#define ALIGNGS_NEXT_TERM(Term) , Term
using PixelTerms = PixelTermList<0 ALIGNGS_PIXEL_TERMS(ALIGNGS_NEXT_TERM)>;
#undef ALIGNGS_NEXT_TERM

}  // namespace aligngs
