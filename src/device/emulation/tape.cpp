#include "device/emulation/tape.h"

#include <algorithm>

#include "core/error.h"

namespace aligngs::cuda {
namespace {
thread_local EmulatedTape* recording = nullptr;
}

bool EmulatedTape::like(const EmulatedTape& other) const {
  return std::equal(operations_.begin(), operations_.end(), other.operations_.begin(), other.operations_.end(),
                    [](const Operation& a, const Operation& b) { return a.name == b.name; });
}

EmulatedTape* recording_tape() { return recording; }

ScopedRecording::ScopedRecording(EmulatedTape& tape) { recording = &tape; }
ScopedRecording::~ScopedRecording() { recording = nullptr; }

void refuse_while_recording(const char* what) {
  if (recording == nullptr) return;
  throw Error({ErrorKind::kFailed, std::string(what) + " cannot be part of a graph", {}, {}, {}});
}

}  // namespace aligngs::cuda
