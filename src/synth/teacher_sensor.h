// A simulated phone with a time-of-flight sensor: cameras of its tracker, depth with the sensor's holes and errors.
#pragma once

#include <vector>

#include "core/random.h"
#include "core/thread_pool.h"
#include "synth/shading.h"
#include "synth/teacher_geometry.h"

namespace aligngs {

/// Sizes are those that data sheets and comparisons of such sensors give; the shares of lost pixels are judgement.
struct DepthSensorSettings {
  double range = 4.5;             ///< metres along the ray: nothing returns from beyond
  double noise = 0.002;           ///< metres at no distance, per pixel
  double noise_growth = 0.0012;   ///< metres per square metre: the returning light falls with the square
  double wiggle = 0.004;          ///< metres: systematic error that repeats along the distance
  double wiggle_period = 0.75;    ///< metres: half the modulation's wavelength, at 200 MHz
  double multipath = 0.02;        ///< metres: longest detour over a facing surface near a concave edge
  int multipath_reach = 10;       ///< pixels of 320 between a pixel and the surface that lights it
  double least_cosine = 0.12;     ///< of the angle between ray and normal: a flatter view returns nothing
  double dark = 0.035;            ///< linear albedo times light: darker surfaces lose pixels
  double dark_loss = 0.8;         ///< share of pixels lost on such surfaces
  double unreliable_loss = 0.85;  ///< the same on glass, screens and dark gloss
  double mirrored_loss = 0.25;    ///< mirrored share of the light (RenderedView::mirrored): above, nothing returns
  /// pixels of the sensor in a row. An edge mixes over one and a half of them. Noise and losses are those of its pixels,
  /// brought to the size of the photo.
  int columns = 256;
  double rotation_degrees = 0.35;  ///< of the tracker, root mean square of the angle
  double translation = 0.010;      ///< metres, the same
  double drift = 0.9;              ///< correlation of the tracker's errors between neighbouring views
  double focal = 0.003;            ///< relative, one for all views
};

/// The report of phone and sensor on exact views (in the order of the walk). The world stays metric. Confidence is 1 at
/// edges and near the range, 2 elsewhere, 0 without a value. A mirror has the depth of the room in it
/// (RenderedView::sensed). The same for any number of threads.
GeometryTeacher simulate_depth_sensor(const std::vector<RenderedView>& views, const DepthSensorSettings& settings,
                                      Random random, ThreadPool& pool);

}  // namespace aligngs
