#include "file_input.h"
#include "fuzz_target.h"
#include "room/room_json.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  return aligngs::accept_or_refuse(data, size, [](const std::string& bytes) {
    const aligngs::MeasuredRoom room = aligngs::read_room(aligngs::FileInput(bytes).path());
    const std::string text = aligngs::room_json(room);  // a room that was accepted reads back
    aligngs::read_room(aligngs::FileInput(text).path());
  });
}
