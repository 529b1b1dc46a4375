// Points of a surface that photos show.
#pragma once

#include <cstdint>
#include <vector>

#include "core/thread_pool.h"
#include "scene/camera.h"
#include "scene/triangle_mesh.h"

namespace aligngs {

/// Flag per point: it lies in the image of some camera with nothing of `surface` between. Points lie on the surface, and
/// units are metres. The same for any number of threads.
std::vector<uint8_t> seen_from(const std::vector<Camera>& cameras, const std::vector<Vec3f>& points,
                               const TriangleMesh& surface, ThreadPool& pool);

}  // namespace aligngs
