// A simulated feed-forward reconstruction network: cameras, depth and confidence with its kinds of error.
#pragma once

#include <vector>

#include "core/image.h"
#include "core/random.h"
#include "core/thread_pool.h"
#include "synth/shading.h"
#include "synth/teacher_levels.h"
#include "synth/world_bend.h"

namespace aligngs {

/// Output of the network for one view.
struct TeacherView {
  Camera camera;      ///< pose and focal length with their errors
  ImageF depth;       ///< in the teacher's world units along z; 0 where it says nothing
  ImageF confidence;  ///< >= 1 as VGGT's; rises as the view's own error falls, blind to the world's bend
  ImageF own_error;   ///< |log| of depth over bent true depth: the view's error apart from the bend; for tests
  bool outlier = false;
};

struct GeometryTeacher {
  std::vector<TeacherView> views;
  Similarity world;  ///< true world -> teacher's world, before bend and residuals; identity when metric
};

/// Simulates the network on exact views (in the order of the walk). `centre`, `extent`, `up`: of the room, world
/// frame. The errors of a view depend on the seed and on its own content, never on the truth of other views.
GeometryTeacher simulate_geometry_teacher(const std::vector<RenderedView>& views,
                                          const GeometryTeacherSettings& settings, const Vec3d& centre, double extent,
                                          const Vec3d& up, Random random, ThreadPool& pool);

/// The teacher without errors: exact cameras and depth, confidence 10 everywhere.
GeometryTeacher exact_geometry_teacher(const std::vector<RenderedView>& views);

}  // namespace aligngs
