#include "refine/scene_copy.h"

#include "core/error.h"
#include "scene/scene_json.h"

namespace aligngs {

namespace fs = std::filesystem;

void require_outside(const fs::path& scene, const fs::path& output) {
  const fs::path inside = fs::weakly_canonical(output).lexically_relative(fs::weakly_canonical(scene));
  if (inside.empty() || inside == "." || *inside.begin() == "..") return;
  throw_usage(output.string() + " lies in the scene that is copied", "give a folder outside it");
}

void copy_scene(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::copy(from, to, fs::copy_options::recursive, error);
  if (error) throw_resources(to, "the scene cannot be copied: " + error.message(), "free some disk space");
}

void write_training_exposure(const Scene& scene, const std::vector<Vec3f>& log_gains, const fs::path& folder) {
  ExposureJson exposure;
  for (size_t i = 0; i < log_gains.size(); ++i) exposure[scene.views[static_cast<size_t>(scene.train[i])].name] = log_gains[i];
  write_exposure_json(folder / "exposure.json", exposure);
}

}  // namespace aligngs
