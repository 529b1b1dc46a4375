// The description files of a scene folder: one input is tried as each of them.
#include "file_input.h"
#include "fuzz_target.h"
#include "scene/label_set.h"
#include "scene/scene_json.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace aligngs;
  const auto as = [&](auto read) {
    accept_or_refuse(data, size, [&](const std::string& bytes) { read(FileInput(bytes).path()); });
  };
  as([](const std::filesystem::path& file) { read_scene_json(file); });
  as([](const std::filesystem::path& file) { read_split_json(file); });
  as([](const std::filesystem::path& file) { read_priors_json(file); });
  as([](const std::filesystem::path& file) { read_exposure_json(file); });
  as([](const std::filesystem::path& file) { read_label_csv(file); });
  return 0;
}
