// Multi-view stereo near the prior depth: where the photos say something, they say it better than a network.
#pragma once

#include <functional>
#include <vector>

#include "core/thread_pool.h"
#include "refine/log_correction.h"
#include "refine/semi_global.h"
#include "refine/stereo_sweep.h"

namespace aligngs {

struct StereoSettings {
  SweepSettings sweep;
  SemiGlobalSettings choice;
  LogCorrectionSettings spread;
  int neighbours = 5;          ///< photos that one is compared with
  double least_overlap = 0.3;  ///< of a photo's pixels inside of the other
  double largest_turn = 45;    ///< degrees between viewing directions
  double good_angle = 12;      ///< degrees between the rays of two photos; smaller angles tell less and count less
  double least_score = 0.4;    ///< correlation below which a pixel knows nothing; at 1 it is sure
  double cost_noise = 0.02;    ///< of the cost, besides what is left of it at the best hypothesis
  double sigma = 0.016;        ///< log units: a pixel whose depth is known as well as this is half sure
  double agreement = 0.02;     ///< relative: depths of two photos this near confirm each other
  int least_patch = 50;        ///< pixels: smaller patches of confirmed depth without a jump are chance; 0 keeps all
};

/// Measurements of the photos about one of them.
struct StereoResult {
  ImageF log_factor;    ///< H x W, on the prior depth, spread over all of it
  ImageF own_factor;    ///< H x W: the pixel's own measurement of it, where the certainty is not 0
  ImageF certainty;     ///< H x W in [0, 1]: of the pixel's own measurement
  double measured = 0;  ///< share of pixels with prior depth whose own measurement was confirmed by another photo
};

/// By view, the photos to compare it with, best first: those that see most of the same, from far enough apart.
std::vector<std::vector<int>> stereo_partners(const std::vector<const MatchView*>& views,
                                              const StereoSettings& settings);

/// One result per view. Views without depth, or that see nothing of the others, get zeros. Deterministic for any number
/// of threads.
std::vector<StereoResult> guided_stereo(const std::vector<const MatchView*>& views, const StereoSettings& settings,
                                        ThreadPool& pool, const std::function<void(double share)>& progress = {});

}  // namespace aligngs
