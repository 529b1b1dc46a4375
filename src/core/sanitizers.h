// Whether this build has a sanitizer. GCC defines a macro, and clang has a feature.
#pragma once

#if defined(__SANITIZE_ADDRESS__)
#define ALIGNGS_ADDRESS_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define ALIGNGS_ADDRESS_SANITIZER 1
#endif
#endif

namespace aligngs {

#ifdef ALIGNGS_ADDRESS_SANITIZER
inline constexpr bool kAddressSanitizer = true;
#else
inline constexpr bool kAddressSanitizer = false;
#endif

}  // namespace aligngs
