// Density control's plan carried out on the device: rows are gathered, new ones displaced and shrunk.
#pragma once

#include "engine/cuda/model_arrays.h"
#include "gaussians/density_control.h"

namespace aligngs::cuda {

/// A plan on the device.
class DevicePlan {
 public:
  /// Every source must be a row of the model.
  DevicePlan(DeviceContext& context, const RestructurePlan& plan);
  size_t rows() const { return source_.size(); }

  struct Spans {
    DeviceSpan<const uint32_t> source;      ///< [rows] row of the old model
    DeviceSpan<const uint8_t> kept;         ///< [rows] 1: kept, 0: new
    DeviceSpan<const float> offset;         ///< [rows][3] added to the position
    DeviceSpan<const float> log_shrink;     ///< [rows] taken from the logarithms of the scales
    DeviceSpan<const float> opacity_logit;  ///< [rows] of new rows, NaN: as the source
  };
  Spans spans() const {
    return {source_.span(), kept_.span(), offset_.span(), log_shrink_.span(), opacity_logit_.span()};
  }

 private:
  DeviceArray<uint32_t> source_;
  DeviceArray<uint8_t> kept_;
  DeviceArray<float> offset_, log_shrink_, opacity_logit_;
};

/// restructure_model of gaussians/restructure.h.
void restructure_model(DeviceContext& context, const DevicePlan& plan, ModelArrays& model);
/// restructure_rows for every array of a moment: new rows are zero.
void restructure_moment(DeviceContext& context, const DevicePlan& plan, ModelArrays& moment);
/// restructure_rows for one number per row.
void restructure_numbers(DeviceContext& context, const DevicePlan& plan, DeviceArray<float>& numbers);

}  // namespace aligngs::cuda
