// How well each true object of a synthetic room can be selected in its run.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/thread_pool.h"
#include "edit/apply_edit.h"
#include "scene/triangle_mesh.h"

namespace aligngs {

/// One object of truth/objects.json (synth/removal_truth.h).
struct TrueObject {
  std::string name;             ///< "lamp#2"
  uint32_t first = 0, end = 0;  ///< vertices [first, end) of truth/mesh.ply
};

/// Error{kBadInput} for a file that is none, and for vertices that a mesh of `vertices` vertices has not.
std::vector<TrueObject> read_true_objects(const std::filesystem::path& file, size_t vertices);

struct ObjectScore {
  std::string object;     ///< true one
  std::string selection;  ///< text that selects it best; empty: none touches it
  double iou = 0;         ///< of the reconstructed surface that each has
  double area = 0;        ///< m^2 of the reconstructed surface that is nearest to the true object
};

struct ObjectScoreOptions {
  double threshold = 0.05;       ///< metres: surface this near to the truth has a true object
  double points_per_area = 2e3;  ///< samples per m^2: a lamp has hundreds
  size_t least_points = 60;      ///< of an object: smaller ones are left out (3 dm^2)
};

/// How many objects of the room are true ones, one by one and whatever their names. Walls, floor and ceiling count on
/// neither side.
struct ObjectDetection {
  size_t truths = 0;  ///< true objects with enough surface
  size_t found = 0;   ///< objects of the run with enough surface
  size_t right = 0;   ///< pairs of them with an IoU above 0.5
  double precision() const { return found > 0 ? static_cast<double>(right) / static_cast<double>(found) : 0; }
  double recall() const { return truths > 0 ? static_cast<double>(right) / static_cast<double>(truths) : 0; }
  double fscore() const {
    return truths + found > 0 ? 2 * static_cast<double>(right) / static_cast<double>(truths + found) : 0;
  }
};

/// Every surface point of the run's mesh belongs to the object of the nearest true surface, within the threshold. True
/// surface that the room's cameras see goes before hidden one, such as the floor under a rug. The
/// selections are the run's objects, and its classes as wholes, each as an edit selects it. A true object gets the
/// selection with the largest IoU, whatever its name. Walls are one object. Scene units are metres. `detection`: as
/// well, when it is asked for. Error{kBadInput} without a mesh or labels.
std::vector<ObjectScore> score_objects(const EditableRoom& room, const TriangleMesh& truth,
                                       const std::vector<TrueObject>& objects, ThreadPool& pool,
                                       const ObjectScoreOptions& options = {}, ObjectDetection* detection = nullptr);

}  // namespace aligngs
