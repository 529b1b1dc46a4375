#include "fuzz_target.h"
#include "scene/camera_path_json.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  return aligngs::accept_or_refuse(data, size, [](const std::string& bytes) {
    const aligngs::CameraPath path = aligngs::parse_camera_path(bytes, "fuzz");
    for (int i = 0; i <= 8; ++i)
      aligngs::camera_of(aligngs::key_at(path, path.begin() + path.duration() * i / 8), {0, 0, 1}, 64, 48);
  });
}
