// A mesh in an exported page: small numbers that compress well.
#pragma once

#include <string>

#include "scene/triangle_mesh.h"

namespace aligngs {

/// Not compressed. A line of JSON is first, {"vertices", "triangles", "low": [3], "step", "colors", "labels"}. Planes of
/// bytes follow: the lowest bytes of all numbers of a column, then the higher ones. Columns hold differences from the
/// number before, with the sign in the lowest bit.
///
/// The columns in this order:
/// - x, y and z, two planes each. A place is low + number x step, finer than a ten-thousandth of the room.
/// - Red, green and blue, one plane each, modulo 256. They are absent without colours.
/// - The class + 1, or 0 for none, two planes. It is absent without labels.
/// - The corners of the triangles, four planes: the number of vertices that occurred, minus the vertex.
std::string packed_mesh(TriangleMesh mesh);

}  // namespace aligngs
