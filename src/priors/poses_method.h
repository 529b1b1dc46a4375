// The source of the cameras of photos, and whether their units become metres, as a person asks for it.
#pragma once

#include "core/choice_words.h"

namespace aligngs {

enum class PosesMethod {
  kAuto,  ///< of a request alone: choose_cameras() takes another
  kVggt,
  kDa3,
  kColmap,
  kGiven
};
template <>
inline constexpr std::array<ChoiceWord<PosesMethod>, 5> kChoiceWords<PosesMethod> = {{{PosesMethod::kAuto, "auto"},
                                                                                      {PosesMethod::kVggt, "vggt"},
                                                                                      {PosesMethod::kDa3, "da3"},
                                                                                      {PosesMethod::kColmap, "colmap"},
                                                                                      {PosesMethod::kGiven, "given"}}};

/// The network of the registry that tells metres beside one with arbitrary units.
inline constexpr const char* kMetricModel = "da3metric-large";

enum class MetresChoice {
  kAuto,  ///< where its weights are installed
  kNone,
  kNetwork  ///< its weights are needed
};
template <>
inline constexpr std::array<ChoiceWord<MetresChoice>, 3> kChoiceWords<MetresChoice> = {
    {{MetresChoice::kAuto, "auto"}, {MetresChoice::kNone, "none"}, {MetresChoice::kNetwork, kMetricModel}}};

}  // namespace aligngs
