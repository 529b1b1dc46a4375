// Faces of a mesh that share an edge.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "scene/triangle_mesh.h"

namespace aligngs {

inline constexpr uint32_t kNoFace = 0xffffffffu;

/// An edge of more than two faces.
enum class CrowdedEdge { kJoinsNone, kJoinsFirstTwo };

/// Per face the one across its edges 0-1, 1-2 and 2-0, or kNoFace.
std::vector<std::array<uint32_t, 3>> face_neighbours(const TriangleMesh& mesh, CrowdedEdge crowded);

}  // namespace aligngs
