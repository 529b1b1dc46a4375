// A real capture as a feed-forward network would see it: the simulated teacher on true surface and cameras.
#pragma once

#include <cstdint>
#include <filesystem>

#include "core/thread_pool.h"
#include "scene/scene.h"
#include "synth/teacher_geometry.h"

namespace aligngs {

struct SimulatedPriorOptions {
  TeacherLevel level = TeacherLevel::kMedium;
  uint64_t seed = 1;  ///< another one: another draw of all errors
  bool overwrite = false;
};

/// Writes a scene with the photos, split and truth of `scene`, but with the cameras, depth and points of the simulated
/// network. The network is the teacher of synthetic rooms, with errors of the same sizes. Its truth mesh is seen
/// through its true cameras, then everything is disturbed. priors.json calls the result simulated. Labels are not made:
/// their values are unknown. Errors: kBadInput for a scene without truth mesh, or one that is not in metres, the unit
/// of the errors; kUsage as SceneWriter.
void write_simulated_priors(const Scene& scene, const std::filesystem::path& folder,
                            const SimulatedPriorOptions& options, ThreadPool& pool);

}  // namespace aligngs
