// Depth networks as teachers: what their depth means, and how they fill a scene with it.
#pragma once

#include <vector>

#include "core/memory_budget.h"
#include "core/thread_pool.h"
#include "priors/model_store.h"
#include "priors/network_memory.h"
#include "priors/scene_priors.h"
#include "scene/scene_json.h"

namespace aligngs {

/// Writes the depth of a scene's training views and priors.json with `notes`, and adds to the report.
using FillDepth = void (*)(const Scene&, const ModelStore&, const PublishedModel&, PriorsJson notes,
                           const ScenePriorsOptions&, ThreadPool&, ScenePriorsReport&);
/// Memory of a network and of what it makes of `photos` (pixels), item by item. Reads the headers of its weights.
using AddDepthMemory = void (*)(MemoryBudget&, const ModelStore&, const PublishedModel&,
                                const std::vector<NetworkInput>& photos, const NetworkMemoryOptions&);

/// Networks of one design, as the rows of priors/teacher_list.h name them.
struct DepthFamily {
  DepthScale scale;     ///< of the depth
  bool has_confidence;  ///< so that the lowest can be left out
  const char* gives;    ///< the same for people, one line; the manual has it as well
  const char* lighter;  ///< remedy where memory is too small, before "or more memory"
  FillDepth fill;
  AddDepthMemory add_memory;
};

extern const DepthFamily kVggtDepth;   ///< VGGT and networks of its structure
extern const DepthFamily kDa3Depth;    ///< Depth Anything 3 on the scene's cameras
extern const DepthFamily kDepthHeads;  ///< DINOv2 with a DPT or a linear head

}  // namespace aligngs
