// A simulated panoptic network: which pixels of a view are one thing, with its merges, splits and misses.
#pragma once

#include <vector>

#include "core/random.h"
#include "core/thread_pool.h"
#include "scene/segment_file.h"
#include "synth/teacher_semantic.h"

namespace aligngs {

/// Chosen so that the panoptic quality of synth/acceptance.h lies where EoMT-L does. Lengths in image pixels.
struct PanopticTeacherSettings {
  double outline_rms = 2.2;  ///< displacement of mask outlines, correlated over 20 pixels
  double missed = 0.09, missed_small = 0.27, missed_large = 0.04;  ///< chance that an object has no segment
  double unsure = 0.5;         ///< chance that an ambiguous object has none: no class of it is sure enough
  double merged = 0.35;        ///< chance that two things of a class that touch in a view are one segment
  double merged_apart = 0.15;  ///< the same for two that are near each other
  double split = 0.06;         ///< chance that a thing is two segments
  double half_missed = 0.3;    ///< share of these of which one half has none
  double flip = 0.06;          ///< chance that a view names an object wrongly for once
};
PanopticTeacherSettings panoptic_teacher_settings(TeacherLevel level);

/// Simulates the network on exact views, at their size. Objects are those of `room`; `confusions` are those of the
/// scene's semantic teacher, of which it is a second output.
std::vector<SegmentMap> simulate_panoptic_teacher(const std::vector<RenderedView>& views, const RoomModel& room,
                                                  const std::vector<ObjectConfusion>& confusions,
                                                  const PanopticTeacherSettings& settings,
                                                  const SemanticTeacherSettings& semantic, Random random,
                                                  ThreadPool& pool);
/// One segment for each object that a view shows, and one for each class of stuff.
SegmentMap exact_segments(const RenderedView& view);

/// Panoptic quality (Kirillov et al., CVPR 2019), the mean over the classes that `truth` has. A class has the sum of the
/// IoU of its matches, over their number plus half of the segments without a match on either side. A segment matches a
/// true one of its class if their IoU is above 0.5. 0 without any class. The vectors have the same views.
double panoptic_quality(const std::vector<SegmentMap>& truth, const std::vector<SegmentMap>& said);

}  // namespace aligngs
