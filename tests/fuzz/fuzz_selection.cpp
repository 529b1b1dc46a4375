#include "edit/selection_text.h"
#include "fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const aligngs::Vocabulary vocabulary(aligngs::ade20k_labels());
  return aligngs::accept_or_refuse(data, size, [](const std::string& bytes) {
    const std::string text = aligngs::selection_text(aligngs::parse_selection(bytes, vocabulary), vocabulary.labels());
    const std::string again = aligngs::selection_text(aligngs::parse_selection(text, vocabulary), vocabulary.labels());
    if (text != again) __builtin_trap();  // the canonical text is the same selection
  });
}
