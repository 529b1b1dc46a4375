#include "core/version.h"

namespace aligngs {

const char* version() { return ALIGNGS_VERSION; }

}  // namespace aligngs
