// Content that often lies where a picture, a map or a cloud should be.
#pragma once

#include <filesystem>
#include <string_view>

namespace aligngs {

/// Error{kBadInput} that says what the content is: nothing at all, a web page, or a pointer of Git LFS. Returns for any
/// other content. For readers whose format `bytes`, the first of the file, are not.
void refuse_foreign_content(std::string_view bytes, const std::filesystem::path& file);

}  // namespace aligngs
