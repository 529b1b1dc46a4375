// Owning arrays on the device in the shape of a model: its parameters, a moment, gradients.
#pragma once

#include "device/device_memory.h"
#include "engine/cuda/model_spans.h"
#include "gaussians/gaussian_model.h"

namespace aligngs::cuda {

class ModelArrays {
 public:
  /// Contents are undefined.
  void resize(DeviceContext& context, size_t gaussians, int channels, const char* what);
  void set_zero(const DeviceContext& context);
  void upload(DeviceContext& context, const GaussianModel& from, const char* what);
  /// All but sh_degree.
  void download(GaussianModel& to) const;
  /// positions, scales, rotations and opacities; the rest of `to` stays
  void download_shapes(GaussianModel& to) const;
  /// body(array, numbers per row) for each array.
  template <class Body>
  void for_each(const Body& body) {
    body(positions_, size_t(3));
    body(log_scales_, size_t(3));
    body(rotations_, size_t(4));
    body(sh_, size_t(3) * kShCoefficients);
    body(semantics_, static_cast<size_t>(channels_));
    body(opacity_logits_, size_t(1));
  }

  size_t size() const { return opacity_logits_.size(); }
  int channels() const { return channels_; }
  ModelSpans spans() const;
  /// Bytes of one with these sizes.
  static uint64_t bytes(size_t gaussians, int channels);

 private:
  int channels_ = 0;
  // Mutable: what a span allows to write is the holder's business, as with a pointer.
  mutable DeviceArray<float> positions_, log_scales_, rotations_, opacity_logits_, sh_, semantics_;
};

}  // namespace aligngs::cuda
