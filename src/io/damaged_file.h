// The remedy of every reader for a file that ends early or contradicts itself.
#pragma once

namespace aligngs {

inline constexpr const char* kDamagedFileRemedy = "the file is truncated or damaged; copy or create it again";

}  // namespace aligngs
