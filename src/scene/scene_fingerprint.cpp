// scene_fingerprint of scene.h.
#include <cstring>

#include "scene/scene.h"
#include "scene/segment_file.h"
#include "scene/sha256.h"

namespace aligngs {
namespace {

/// Feeds values with their lengths, so that no two scenes give the same bytes.
class Digest {
 public:
  void add(uint64_t number) {
    uint8_t bytes[8];
    for (int i = 0; i < 8; ++i) bytes[i] = static_cast<uint8_t>(number >> (8 * i));
    hash_.update(bytes, 8);
  }
  void add(double number) {
    uint64_t bits;
    std::memcpy(&bits, &number, 8);
    add(bits);
  }
  void add(const std::string& text) {
    add(static_cast<uint64_t>(text.size()));
    hash_.update(text);
  }
  /// The size of a file; absent and unreadable ones count as size 2^64 - 1.
  void add_file(const std::filesystem::path& path) {
    std::error_code error;
    const uint64_t size = path.empty() ? ~uint64_t(0) : std::filesystem::file_size(path, error);
    add(error ? ~uint64_t(0) : size);
  }
  void add(const Camera& camera) {
    add(static_cast<uint64_t>(camera.width));
    add(static_cast<uint64_t>(camera.height));
    for (double value : {camera.fx, camera.fy, camera.cx, camera.cy}) add(value);
    for (double value : camera.world_to_camera.rotation.m) add(value);
    for (int k = 0; k < 3; ++k) add(camera.world_to_camera.translation[k]);
  }
  std::string finish() { return hash_.finish(); }

 private:
  Sha256 hash_;
};

}  // namespace

std::string scene_fingerprint(const Scene& scene) {
  Digest digest;
  digest.add(static_cast<uint64_t>(scene.views.size()));
  for (const View& view : scene.views) {
    digest.add(view.name);
    digest.add(view.camera);
    if (view.log_gain.x != 0 || view.log_gain.y != 0 || view.log_gain.z != 0) {
      for (int k = 0; k < 3; ++k) digest.add(static_cast<double>(view.log_gain[k]));
    }
    for (const auto* path : {&view.image, &view.prior_depth, &view.semantics}) digest.add_file(*path);
    if (const auto file = segment_file_of(scene, view); std::filesystem::is_regular_file(file)) digest.add_file(file);
  }
  for (const std::vector<int>* list : {&scene.train, &scene.test}) {
    digest.add(static_cast<uint64_t>(list->size()));
    for (int view : *list) digest.add(static_cast<uint64_t>(view));
  }
  digest.add(static_cast<uint64_t>(scene.cloud.size()));
  digest.add(static_cast<uint64_t>(scene.metric));
  digest.add(static_cast<uint64_t>(scene.semantic_kind));
  digest.add(static_cast<uint64_t>(scene.labels.size()));
  for (const LabelClass& label : scene.labels.classes) digest.add(label.name);
  return digest.finish();
}

}  // namespace aligngs
