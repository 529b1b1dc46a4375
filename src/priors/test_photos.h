// Photos that are kept for testing (--test-every).
#pragma once

#include <cstddef>
#include <filesystem>

namespace aligngs {

/// Every n-th photo is kept for testing, from the first on; 0: none.
inline bool is_test_photo(size_t index, int test_every) {
  return test_every > 0 && index % static_cast<size_t>(test_every) == 0;
}

/// Error{kBadInput} where this leaves fewer than kFewestTrainingViews of `photos` for training. The remedy is the
/// smallest number that leaves enough. `source` is named as their place.
void require_training_photos(const std::filesystem::path& source, size_t photos, int test_every);

}  // namespace aligngs
