// A small synthetic room on disk, made once per test program.
#pragma once

#include <filesystem>

#include "synth/synth_scene.h"

namespace aligngs::testing_support {

struct SmallSceneOptions {
  int width = 64, height = 48;
  int views = 8, test_views = 2;
  bool exact = true;
  bool truth = true;  // without it a run compares nothing with the truth, which takes seconds
};

inline SynthScene make_small_scene(const SmallSceneOptions& small, ThreadPool& pool) {
  SynthOptions options;
  options.width = small.width;
  options.height = small.height;
  options.views = small.views;
  options.test_views = small.test_views;
  options.samples_per_side = 1;
  options.teacher = small.exact ? TeacherKind::kExact : TeacherKind::kSimulated;
  options.degrade_images = !small.exact;
  return make_synth_scene(options, pool);
}

/// Writes the scene into a fresh folder.
inline void write_small_scene(const std::filesystem::path& folder, const SmallSceneOptions& small = {}) {
  std::filesystem::remove_all(folder);
  ThreadPool pool;
  write_synth_scene(make_small_scene(small, pool), folder);
  if (!small.truth) std::filesystem::remove_all(folder / "truth");
}

}  // namespace aligngs::testing_support
