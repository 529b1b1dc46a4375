// Surface of a fused mesh that no view sees: sheets in the gaps behind things.
#pragma once

#include <cstddef>
#include <vector>

#include "core/thread_pool.h"
#include "scene/camera.h"
#include "scene/triangle_mesh.h"

namespace aligngs {

/// Removes the triangles of which no camera sees a corner, and the vertices that nothing uses then. A corner is seen
/// where no surface of the mesh lies before it in some image. The last `tolerance` (scene units) before it does not
/// count: fused surfaces are rough, and thin things have two. Depth bleeds along the rays at the edge of a thing, and
/// leaves a sheet between the thing and what is behind. Attributes follow, and the order of what stays is kept. Without
/// cameras nothing goes. Returns how many triangles went. The same for any number of threads.
size_t remove_unseen_surface(TriangleMesh& mesh, const std::vector<Camera>& cameras, double tolerance,
                             ThreadPool& pool);

}  // namespace aligngs
