// From depth maps of many views to one mesh: parameters from the data, weights, TSDF, surface, cleaning.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/thread_pool.h"
#include "mesh/fusion_frame.h"
#include "mesh/hole_filling.h"
#include "mesh/mesh_cleaning.h"
#include "mesh/tsdf_device.h"
#include "mesh/view_consistency.h"

namespace aligngs {

/// Lengths are in scene units; 0 means "choose from the data". The bounds below are in metres; a scene
/// without metric units is taken for a room whose robust extent is kTypicalExtent metres.
struct FusionOptions {
  bool metric = false;    ///< scene units are metres
  double extent = 0;      ///< robust extent of the scene; 0: from the depth maps. Used when not metric
  double voxel = 0;       ///< 0: max(1.5 x median pixel footprint, 0.75 x median two-view residual), in 0.5 to 1.5 cm
  double truncation = 0;  ///< 0: max(4 voxels, 3 x median two-view residual), within 3 and 5 cm, and >= 2 voxels
  double max_depth = 0;   ///< 0: max_depth_factor x the quantile of depth
  double depth_quantile = 0.95;
  /// Cutting at the quantile itself is too near. On the real kitchen (sensor depth) that loses 6 points of recall and,
  /// as far views no longer carve, 2 of precision. F at 5 cm is 0.930, against 0.974 with 1.5, which still stops
  /// runaways.
  double max_depth_factor = 1.5;
  double min_alpha = 0;              ///< of a pixel: less is a surface only half seen
  double min_cosine = 0;             ///< between viewing ray and surface normal; flatter looks are left out
  double single_view_weight = 1;     ///< of surface that one view alone sees; 0 drops it
  double contradicted_weight = 0;    ///< of surface that another view looks through
  double interpolated_weight = 0.3;  ///< of interpolated views, at most 0.3
  ConsistencyOptions consistency;
  bool carve = true;              ///< see TsdfOptions
  bool tangent_distance = false;  ///< distances from tangent planes, where frames have normals, instead of along rays
  double min_weight = 1e-4;       ///< of a voxel; 1 is a frontal look from the median depth
  double min_component_area = 0;  ///< 0: 25 cm^2; negative: keep all
  double max_hole = 0;  ///< scene units: holes up to this size are closed where views have seen surface; 0: none
  double min_component_extent = 0;     ///< 0: 10 cm; negative: keep all
  int face_filter = 0;                 ///< rounds of the filter over face normals; vertices move by a voxel at most
  uint64_t max_bytes = 0;              ///< of the volume and its surface; 0: 80 % of the memory that is free now
  std::shared_ptr<TsdfDevice> device;  ///< where views are fused; none: on the CPU. The result is the same
};

inline constexpr double kTypicalExtent = 3;  ///< metres: half the diagonal of a room of 4.5 x 3 x 2.5 m

/// Chosen values and results.
struct FusionReport {
  double voxel = 0, truncation = 0, max_depth = 0;  ///< scene units
  double metre = 1;                                 ///< scene units per metre, estimated when not metric
  double median_footprint = 0, two_view_residual = 0, median_depth = 0;
  size_t training_views = 0, interpolated_views = 0;
  size_t pixels = 0;                                        ///< of training views with usable depth
  double confirmed = 0, single_view = 0, contradicted = 0;  ///< shares of them
  size_t blocks = 0;
  uint64_t predicted_bytes = 0, budget_bytes = 0;
  size_t unseen_triangles = 0;  ///< removed: no training view sees them (mesh/unseen_surface.h)
  CleaningReport cleaning;
  HoleFillingReport holes;
  size_t vertices = 0, triangles = 0;
  double seconds = 0;
  std::string text() const;  ///< one line for the log
};

struct FusionResult {
  TriangleMesh mesh;  ///< with normals and colours; empty when nothing was seen
  FusionReport report;
};

/// Error{kBadInput} for maps that do not fit, Error{kResources} when the volume does not fit max_bytes, Error{kUsage}
/// for settings that contradict each other. The predicted memory is logged before it is allocated. The result is the
/// same for any number of threads; the order of the frames is the order of fusion (training views first).
FusionResult fuse_depth(const std::vector<FusionFrame>& frames, const FusionOptions& options, ThreadPool& pool);

}  // namespace aligngs
