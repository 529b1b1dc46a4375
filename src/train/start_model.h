// Start of the Gaussians of a run: fused prior depth, the scene's cloud, or random points.
#pragma once

#include <vector>

#include "core/random.h"
#include "core/thread_pool.h"
#include "engine/training_view.h"
#include "gaussians/gaussian_model.h"
#include "scene/point_cloud.h"
#include "train/config.h"
#include "train/schedule.h"

namespace aligngs {

struct StartInputs {
  const TrainConfig& config;
  const std::vector<TrainingView>& views;
  const std::vector<float>& depth_scales;  ///< a_v per view
  const PointCloud& cloud;                 ///< sparse/points3D
  PriorDepthKind prior_depth = PriorDepthKind::kNone;
  int semantic_channels = 0;
  int64_t max_gaussians = 1;  ///< start_limit() of training_set.h
  double extent = 1;          ///< robust scene extent, scene units
  ThreadPool& pool;
  bool sensor_depth = false;  ///< the prior depth is a sensor's
};

struct StartModel {
  GaussianModel model;
  bool dense = false;        ///< from prior depth
  bool has_normals = false;  ///< the shortest axes lie along surface normals
};

/// init.start "auto": prior depth when it is metric, else the cloud, else random points with a warning. The number is
/// at most max_gaussians, reached by coarser thinning. Error{kBadInput} when the wanted source holds no point (remedy: another start).
StartModel make_start_model(const StartInputs& inputs, Random random);

}  // namespace aligngs
