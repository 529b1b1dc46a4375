// The viewer page, embedded in the program: web/dist, compressed with gzip when the program was built.
#pragma once

#include <span>
#include <string_view>

namespace aligngs {

/// The gzip-compressed file at a path such as "/app.js", or an empty span.
std::span<const unsigned char> embedded_page_file(std::string_view path);

}  // namespace aligngs
