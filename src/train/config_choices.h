// The settings that are one of several words (config.h), as enums with their words.
#pragma once

#include "core/choice_words.h"
#include "engine/settings.h"

namespace aligngs {

enum class PriorDepthUse {
  kAuto,      ///< metric where its scale can be brought to the scene's, else relative
  kMetric,    ///< in scene units: for start, losses and free space
  kRelative,  ///< its correlation with rendered depth alone
  kNone
};
template <>
inline constexpr std::array<ChoiceWord<PriorDepthUse>, 4> kChoiceWords<PriorDepthUse> = {
    {{PriorDepthUse::kAuto, "auto"},
     {PriorDepthUse::kMetric, "metric"},
     {PriorDepthUse::kRelative, "relative"},
     {PriorDepthUse::kNone, "none"}}};

enum class StartSource {
  kAuto,   ///< prior depth when it is metric, else the cloud
  kDepth,  ///< fused prior depth
  kCloud,  ///< sparse/points3D
  kRandom
};
template <>
inline constexpr std::array<ChoiceWord<StartSource>, 4> kChoiceWords<StartSource> = {
    {{StartSource::kAuto, "auto"},
     {StartSource::kDepth, "depth"},
     {StartSource::kCloud, "cloud"},
     {StartSource::kRandom, "random"}}};

enum class Preset { kPreview, kDefault, kPaper, kHigh, kPgsr };
inline constexpr size_t kPresets = 5;
template <>
inline constexpr std::array<ChoiceWord<Preset>, kPresets> kChoiceWords<Preset> = {{{Preset::kPreview, "preview"},
                                                                                   {Preset::kDefault, "default"},
                                                                                   {Preset::kPaper, "paper"},
                                                                                   {Preset::kHigh, "high"},
                                                                                   {Preset::kPgsr, "pgsr"}}};

enum class GrowthStrategy {
  kAdaptive,  ///< DensityRule: clone, split, prune
  kMcmc       ///< McmcRule: relocate, add, noise
};
template <>
inline constexpr std::array<ChoiceWord<GrowthStrategy>, 2> kChoiceWords<GrowthStrategy> = {
    {{GrowthStrategy::kAdaptive, "adaptive"}, {GrowthStrategy::kMcmc, "mcmc"}}};

/// Rendered depth that is fused.
enum class FusedDepth {
  kAgreeing,  ///< plane depth where it agrees with the median, else the median
  kMedian,
  kPlane,
  kExpected
};
template <>
inline constexpr std::array<ChoiceWord<FusedDepth>, 4> kChoiceWords<FusedDepth> = {
    {{FusedDepth::kAgreeing, "agreeing"},
     {FusedDepth::kMedian, "median"},
     {FusedDepth::kPlane, "plane"},
     {FusedDepth::kExpected, "expected"}}};

template <>
inline constexpr std::array<ChoiceWord<SemanticBlend>, 2> kChoiceWords<SemanticBlend> = {
    {{SemanticBlend::kProbabilities, "probabilities"}, {SemanticBlend::kLogits, "logits"}}};
template <>
inline constexpr std::array<ChoiceWord<SemanticCoupling>, 3> kChoiceWords<SemanticCoupling> = {
    {{SemanticCoupling::kBounded, "bounded"},
     {SemanticCoupling::kPlain, "plain"},
     {SemanticCoupling::kOpacity, "opacity"}}};

}  // namespace aligngs
