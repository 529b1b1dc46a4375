#include "engine/cuda/model_arrays.h"

namespace aligngs::cuda {
namespace {
constexpr size_t kHarmonicsPerGaussian = size_t(3) * kShCoefficients;
}

void ModelArrays::resize(DeviceContext& context, size_t gaussians, int channels, const char* what) {
  channels_ = channels;
  positions_.resize(context, 3 * gaussians, what);
  log_scales_.resize(context, 3 * gaussians, what);
  rotations_.resize(context, 4 * gaussians, what);
  opacity_logits_.resize(context, gaussians, what);
  sh_.resize(context, kHarmonicsPerGaussian * gaussians, what);
  semantics_.resize(context, static_cast<size_t>(channels) * gaussians, what);
}

void ModelArrays::set_zero(const DeviceContext& context) {
  for_each([&](DeviceArray<float>& a, size_t) { fill_zero(context, a.span()); });
}

void ModelArrays::upload(DeviceContext& context, const GaussianModel& from, const char* what) {
  resize(context, from.size(), from.semantic_channels, what);
  cuda::upload(context, positions_.span(), from.positions.data());
  cuda::upload(context, log_scales_.span(), from.log_scales.data());
  cuda::upload(context, rotations_.span(), from.rotations.data());
  cuda::upload(context, opacity_logits_.span(), from.opacity_logits.data());
  cuda::upload(context, sh_.span(), from.sh.data());
  cuda::upload(context, semantics_.span(), from.semantics.data());
}

void ModelArrays::download(GaussianModel& to) const {
  download_shapes(to);
  to.semantic_channels = channels_;
  to.sh = sh_.to_host();
  to.semantics = semantics_.to_host();
}

void ModelArrays::download_shapes(GaussianModel& to) const {
  to.positions = positions_.to_host();
  to.log_scales = log_scales_.to_host();
  to.rotations = rotations_.to_host();
  to.opacity_logits = opacity_logits_.to_host();
}

ModelSpans ModelArrays::spans() const {
  return {
      size(),     channels_,        positions_.span(), log_scales_.span(), rotations_.span(), opacity_logits_.span(),
      sh_.span(), semantics_.span()};
}

uint64_t ModelArrays::bytes(size_t gaussians, int channels) {
  return uint64_t(gaussians) * (3 + 3 + 4 + 1 + kHarmonicsPerGaussian + static_cast<size_t>(channels)) * sizeof(float);
}

}  // namespace aligngs::cuda
