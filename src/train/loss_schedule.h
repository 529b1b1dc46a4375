// The schedule of the losses: one row per weight, with its settings and the condition under which it acts.
#pragma once

#include <array>
#include <string_view>

#include "engine/loss_catalogue.h"
#include "train/config.h"

namespace aligngs {

/// Conditions of a step; bits.
enum LossGate : unsigned {
  kAlways = 0,
  kGateSemantics = 1,   ///< the scene has a teacher's classes
  kGateMetric = 2,      ///< its prior depth is metric
  kGateCorrelated = 4,  ///< it is relative, or metric and loss.log_depth is off
  kGateDepth = 8,       ///< the rendered depth means something: past loss.depth_start, and turned Gaussians
  kGateNormals = 16,    ///< past loss.normal_start
  kGateTwoViews = 32    ///< a step with a neighbour
};

struct ScheduledLoss {
  Loss loss;
  std::string_view key;                        ///< the setting of its weight; that of its end has "_end" behind it
  const double& (*start)(const TrainConfig&);  ///< the value of `key`
  const double& (*end)(const TrainConfig&);    ///< at the end of the schedule, log-linear between; nullptr: constant
  unsigned gates;                              ///< bits of LossGate, all of which must be open
};

/// Every loss of the catalogue, in its order.
const std::array<ScheduledLoss, kLosses>& scheduled_losses();

/// The weights of a step. `open`: bits of LossGate; `share` of the schedule that is over, in [0, 1].
PerLoss<float> scheduled_weights(const TrainConfig& config, unsigned open, double share);

/// Some loss with a weight at the start needs one of these inputs; `needs`: bits of LossNeeds.
bool settings_need(const TrainConfig& config, unsigned needs);

/// start^(1 - t) * end^t; 0 when start is 0.
double log_linear(double start, double end, double t);

}  // namespace aligngs
