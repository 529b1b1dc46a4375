// How well a selection matches the true objects, where a scene has a true labelled mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "core/thread_pool.h"
#include "edit/selection_text.h"
#include "scene/camera.h"
#include "scene/triangle_mesh.h"

namespace aligngs {

struct SelectionTruthOptions {
  double threshold = 0.05;       ///< metres: surfaces nearer than this are the same (the project's F-score distance)
  double points_per_area = 1e4;  ///< samples per m^2: 1 per cm^2, thousands on a pillow
};

/// The selected part of the mesh against the part of the true surface with the selected classes that the cameras see.
struct SelectionScore {
  double iou = 0;        ///< P R / (P + R - P R): intersection over union of the two surfaces at the threshold
  double precision = 0;  ///< share of the selected surface within the threshold of the true objects
  double recall = 0;     ///< share of the visible true surface within the threshold of the selected one
  double label_iou = 0;  ///< over the mesh surface that has truth: selected and truly so / either; blind to geometry
  double selected_area = 0, true_area = 0;  ///< m^2
};

/// `mesh` with one flag per vertex, and the true mesh with labels, in one world in metres. Error{kBadInput} when the
/// truth has no labels or none of the classes; Error{kUsage} for single objects (truth has classes only).
SelectionScore score_selection(const TriangleMesh& mesh, const std::vector<uint8_t>& flags, const TriangleMesh& truth,
                               const SelectionQuery& query, const std::vector<Camera>& cameras, ThreadPool& pool,
                               const SelectionTruthOptions& options = {});

}  // namespace aligngs
