// A simulated single-image depth network (DINOv2 + DPT): plausible in each view, not consistent between views.
#pragma once

#include "synth/teacher_geometry.h"

namespace aligngs {

/// Chosen so that the figures of synth/acceptance.h lie where published networks do. Shares are relative to the depth.
struct MonoDepthSettings {
  double view_scale = 0.077;                       ///< so that the RMSE is that of published monocular networks
  double view_shift = 0.08;                        ///< metres
  double warp_rms = 0.04;                          ///< correlation length: a quarter of the image
  double object_offset = 0.03;                     ///< per object, half of its variance shared by all views
  double edge_width_low = 4, edge_width_high = 6;  ///< pixels of the image
};
/// low: 0.6, medium: 1, high: 1.5 times the default error sizes.
MonoDepthSettings mono_depth_settings(TeacherLevel level);

/// Metric depth of one view with errors; 0 where the view has no surface. `random` is the teacher's generator
/// (the same for all views), `view` the number of the view.
ImageF simulate_mono_depth(const RenderedView& view, size_t view_number, const MonoDepthSettings& settings,
                           const Random& random);

}  // namespace aligngs
