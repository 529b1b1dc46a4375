// Standard input, output and error of the process.
#pragma once

namespace aligngs {

/// Opens what the caller has closed (`aligngs ... 2>&-`, some schedulers). Otherwise a file of the program gets the
/// number of a standard stream and, with it, the program's messages. Reading from such a stream finds its end, and
/// writing to it fails, as before. To be called before any file is opened.
void reserve_standard_streams();

}  // namespace aligngs
