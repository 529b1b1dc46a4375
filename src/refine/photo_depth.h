// Depth of photos whose cameras are known and of which nothing else is: multi-view stereo, from coarse to fine.
#pragma once

#include <functional>
#include <vector>

#include "core/thread_pool.h"
#include "refine/guided_stereo.h"

namespace aligngs {

struct PhotoDepthSettings {
  int coarse_width = 320;     ///< pixels; larger photos are searched over all depths at this width
  double margin = 1.5;        ///< factor by which that search goes beyond the nearest and the farthest points
  double step = 0.012;        ///< log units between its depths: a pixel or so of such photos taken 15 degrees apart
  int most_hypotheses = 201;  ///< of it; wider ranges have longer steps
  /// StereoSettings::sigma and agreement of the search, whose windows do not follow slopes yet
  double coarse_sigma = 0.03;
  double coarse_agreement = 0.03;
  StereoSettings stereo;  ///< of the passes after the search, near the depth found so far
  int coarse_passes = 2;  ///< of these at the coarse width
  int fine_passes = 1;    ///< and at the photos' own
};

struct PhotoDepth {
  /// H x W, scene units, of every pixel: measured, or the smoothest in between; empty: nothing is known
  ImageF depth;
  /// H x W in [0, 1]: of the pixel's own measurement; 0 where it has none that another photo confirms
  ImageF certainty;
  double measured = 0;  ///< share of the pixels whose certainty is not 0
};

/// Moves the depth by the smoothest field of log factors through `given`, each as sure as its weight; both are H x W
/// (refine/log_correction.h).
void move_depth(const ImageF& given, const ImageF& weight, const LogCorrectionSettings& spread, const ImageF& luma,
                PhotoDepth& photo);
/// Share of the pixels of all photos that `counts`, one of each, add up to; 0 without pixels.
double share_of_pixels(const std::vector<size_t>& counts, const std::vector<PhotoDepth>& depths);

/// `views`: camera and luma, MatchView::depth is not read. `points`: world, scene units, of structure from motion.
/// Those in front of a photo bound its search of depth (fewer than eight: the bounds of the other photos). Photos that
/// see nothing of another get empty maps. Deterministic for any number of threads.
std::vector<PhotoDepth> photo_depth(const std::vector<MatchView>& views, const std::vector<Vec3f>& points,
                                    const PhotoDepthSettings& settings, ThreadPool& pool,
                                    const std::function<void(double share)>& progress = {});

}  // namespace aligngs
