// Decides which warnings of libjpeg mean lost pixels. src/io internal: use io/image_file.h.
#pragma once

#include <string>
#include <string_view>

namespace aligngs {

/// Whether pixels are lost, by the first warning of libjpeg about this stream. It gives the text of the first alone.
bool means_damage(std::string_view warning, std::string_view bytes);

/// The stream without the harmless oddities of its headers, so that a warning about its pixels becomes the first.
std::string without_odd_headers(std::string_view bytes);

}  // namespace aligngs
