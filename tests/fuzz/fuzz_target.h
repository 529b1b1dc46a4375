// Common part of all fuzz targets: Error is a parser's right answer to bad bytes, anything
// else is a finding.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "core/error.h"

namespace aligngs {

template <class Parse>
int accept_or_refuse(const uint8_t* data, size_t size, Parse&& parse) {
  try {
    parse(std::string(reinterpret_cast<const char*>(data), size));
  } catch (const Error&) {
  }
  return 0;
}

}  // namespace aligngs
