// Writing ZIP archives. No times: equal content gives equal bytes.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace aligngs {

/// The bytes of an archive with the given entries, all stored. For archives below 4 GiB
/// (Error{kFailed} above). The content of each entry starts at a multiple of `alignment` bytes (USDZ: 64).
std::string make_stored_zip(const std::vector<std::pair<std::string, std::string_view>>& entries, size_t alignment = 1);

/// The same with each entry deflated.
std::string make_deflated_zip(const std::vector<std::pair<std::string, std::string_view>>& entries);

}  // namespace aligngs
