// gzip streams (RFC 1952) in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace aligngs {

/// No time and no name in the header: the same bytes give the same stream.
std::string gzip_compressed(std::string_view bytes, int level = 9);
/// Error{kBadInput} for a damaged stream or more than `limit` bytes.
std::string gzip_expanded(std::string_view bytes, const std::filesystem::path& name_for_errors, uint64_t limit);

}  // namespace aligngs
