// The version of the program, as CMakeLists.txt names it. Only version.cpp is compiled again when it changes.
#pragma once

namespace aligngs {

/// "MAJOR.MINOR.PATCH" by semantic versioning.
const char* version();

}  // namespace aligngs
