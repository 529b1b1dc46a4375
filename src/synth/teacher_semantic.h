// A simulated Mask2Former: class scores per pixel with confusions that persist per object.
#pragma once

#include <cstdint>
#include <vector>

#include "core/random.h"
#include "core/thread_pool.h"
#include "synth/shading.h"
#include "synth/teacher_geometry.h"

namespace aligngs {

/// Chosen so that the figures of synth/acceptance.h lie where published networks do. Lengths in pixels of the image.
struct SemanticTeacherSettings {
  double outline_rms = 3.5;           ///< displacement of mask outlines, correlated over 20 pixels
  double confused_share = 0.22;       ///< of the objects: wrong or ambiguous in most of their views
  double confused_view_share = 0.93;  ///< of such an object's views
  double flip = 0.10;                 ///< chance that a view names an object wrongly for once, for an average view
  double dropped = 0.05, dropped_small = 0.15, dropped_large = 0.02;  ///< chance that an object is not found
  double duplicate = 0.10;                                            ///< share of second queries of the same object
  double low_top = 0.75, high_top = 0.95;                             ///< score of a query's first class
};
SemanticTeacherSettings semantic_teacher_settings(TeacherLevel level);

/// Scores of one view: sum over queries of p_q(class) * m_q(pixel), about [0, 1]. [C][height][width], IEEE half.
struct ScoreMap {
  int channels = 0, width = 0, height = 0;
  std::vector<uint16_t> values;
  float score(int channel, int x, int y) const;
};

/// The confusions of one scene, drawn once: every view of an object shares them.
struct ObjectConfusion {
  bool confused = false;
  bool ambiguous = false;  ///< two classes with nearly the same score, otherwise simply wrong
  uint16_t other = 0;      ///< the class it is taken for
};

/// Draws which objects are confused. One draw in some hundred gives all large pieces or none. The kept draw has the
/// confused share nearest to the expected one, of the pixels of things as well as of their classes. Every scene hence
/// has a teacher of the same quality.
std::vector<ObjectConfusion> draw_object_confusions(const std::vector<RenderedView>& views, const RoomModel& room,
                                                    const SemanticTeacherSettings& settings, Random random);

/// Simulates the network on exact views, at `scale` times their size. Objects are those of `room`.
std::vector<ScoreMap> simulate_semantic_teacher(const std::vector<RenderedView>& views, const RoomModel& room,
                                                const SemanticTeacherSettings& settings, double scale, Random random,
                                                ThreadPool& pool);
/// Scores of 0.97 on the true class (shared by area where a pixel holds several).
std::vector<ScoreMap> exact_semantic_teacher(const std::vector<RenderedView>& views, double scale, ThreadPool& pool);

/// Arg-max class at every pixel of a width x height image: scores are sampled bilinearly at pixel centres.
/// kNoLabel where they sum to less than 0.3 (the network says nothing).
Image<uint16_t> semantic_labels(const ScoreMap& scores, int width, int height);

}  // namespace aligngs
