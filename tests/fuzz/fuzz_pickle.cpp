// The pickle machine alone: inside an archive the checksum hides it from a fuzzer.
#include "fuzz_target.h"
#include "io/pickle.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::vector<std::string> allowed = {"torch._utils _rebuild_tensor_v2", "collections OrderedDict",
                                            "torch FloatStorage"};
  return aligngs::accept_or_refuse(data, size,
                                   [&](const std::string& bytes) { aligngs::Pickle(bytes, allowed, "fuzz"); });
}
