// The specification of the semantic loss of one view: per pixel its value, what its Gaussians' rows receive, and what
// the blending weights receive (coupling).
#pragma once

#include <algorithm>
#include <vector>

#include "engine/formulas/teacher_sampling.h"
#include "engine/reference/reference_forward.h"

namespace aligngs::reference {

/// Values that one pixel passes on; see formulas/semantic_loss.h for g, h and h_0.
template <class T>
struct SemanticPixel {
  bool counts = false;          ///< false: everything else is empty
  std::vector<T> row_gradient;  ///< g, [C]
  std::vector<T> coupling;      ///< h, [C]
  T offset{};                   ///< h_0
};

template <class T>
struct SemanticsOfView {
  const TrainingView& view;
  const LossSettings& settings;
  int channels = 0;
  size_t valid = 0;           ///< pixels that count; 0: the pass is off
  T pixel_weight{};           ///< of a pixel that this step takes, in a mean over the valid ones
  std::vector<T> features;    ///< [N][C] what is blended
  std::vector<T> dfeatures;   ///< [N][C] sum over pixels of w g
  double soft = 0, hard = 0;  ///< means over valid pixels, unweighted, estimated from the pixels taken
  double surrogate = 0;       ///< mean of L_geo; kPlain: 0

  /// On with a teacher of the model's number of classes, a weight and at least one valid pixel.
  SemanticsOfView(const GaussianModelT<T>& model, const TrainingView& training_view, const LossSettings& loss)
      : view(training_view), settings(loss) {
    const bool wanted = loss.weight[Loss::kSemanticSoft] != 0 || loss.weight[Loss::kSemanticHard] != 0;
    if (!wanted || model.semantic_channels == 0 || view.data.semantics.channels != model.semantic_channels) return;
    channels = model.semantic_channels;
    valid = count_semantic_pixels(view.data);
    if (valid == 0) return;
    pixel_weight = T(loss.semantic_sample.scale()) / T(valid);
    features = semantic_features(model, loss.semantic_blend);
    dfeatures.assign(features.size(), T(0));
  }

  /// omega of a pixel in the mean.
  T coupling_weight(int x, int y) const {
    return (view.semantic_weight.empty() ? T(1) : T(view.semantic_weight.at(x, y))) * pixel_weight;
  }

  const T* row(uint32_t i) const { return &features[size_t(i) * channels]; }

  /// Evaluates the loss at a pixel, adds its terms and the rows' gradients.
  SemanticPixel<T> visit(int x, int y, const std::vector<Contribution<T>>& list, T alpha) {
    SemanticPixel<T> out;
    if (valid == 0 || !settings.semantic_sample.takes(x, y)) return out;
    const SemanticTarget& target = view.data.semantics;
    const TeacherTaps taps = teacher_taps(target, x, y, view.data.camera.width, view.data.camera.height);
    out.counts = semantic_pixel_valid(view.data, taps, x, y);
    if (!out.counts) return out;

    std::vector<float> sampled(channels);
    sample_teacher(target, taps, sampled.data());
    const std::vector<T> teacher(sampled.begin(), sampled.end());
    std::vector<T> blended(channels, T(0)), student(channels);
    for (const Contribution<T>& k : list) {
      for (int c = 0; c < channels; ++c) blended[c] += k.weight * row(k.row)[c];
    }

    const bool probabilities = settings.semantic_blend == SemanticBlend::kProbabilities;
    const SemanticWeights<T> weights{T(settings.weight[Loss::kSemanticSoft]) * pixel_weight,
                                     T(settings.weight[Loss::kSemanticHard]) * pixel_weight};
    out.row_gradient.resize(channels);
    const SemanticTerms<T> terms = probabilities
                                       ? semantic_loss_probabilities(blended.data(), alpha, teacher.data(), channels,
                                                                     weights, out.row_gradient.data())
                                       : semantic_loss_logits(blended.data(), teacher.data(), channels, weights,
                                                              student.data(), out.row_gradient.data());
    soft += static_cast<double>(terms.soft * pixel_weight);
    hard += static_cast<double>(terms.hard * pixel_weight);

    out.coupling = out.row_gradient;
    if (settings.coupling == SemanticCoupling::kPlain) {
      out.offset = plain_coupling_offset(probabilities, out.row_gradient.data(), channels);
    } else if (settings.coupling == SemanticCoupling::kOpacity) {
      std::fill(out.coupling.begin(), out.coupling.end(), T(0));
      out.offset = coupling_weight(x, y);
      surrogate -= static_cast<double>(out.offset * alpha);
    } else {
      const T omega = coupling_weight(x, y);
      surrogate +=
          static_cast<double>(probabilities ? bounded_coupling_probabilities(blended.data(), alpha, teacher.data(),
                                                                             channels, omega, out.coupling.data())
                                            : bounded_coupling_logits(student.data(), alpha, teacher.data(), channels,
                                                                      omega, out.coupling.data()));
    }
    for (const Contribution<T>& k : list) {
      for (int c = 0; c < channels; ++c) dfeatures[size_t(k.row) * channels + c] += k.weight * out.row_gradient[c];
    }
    return out;
  }

  /// dL_geo / dw of row i at a visited pixel.
  T coupling_of(const SemanticPixel<T>& pixel, uint32_t i) const {
    if (!pixel.counts) return T(0);
    T q = -pixel.offset;
    for (int c = 0; c < channels; ++c) q += pixel.coupling[c] * row(i)[c];
    return q;
  }

  /// dL / d semantics of row i, after the last pixel.
  void row_gradient(size_t i, T* out) const {
    const T* g = &dfeatures[i * channels];
    if (settings.semantic_blend == SemanticBlend::kProbabilities) {
      softmax_backward(&features[i * channels], g, channels, out);
    } else {
      std::copy(g, g + channels, out);
    }
  }
};

}  // namespace aligngs::reference
