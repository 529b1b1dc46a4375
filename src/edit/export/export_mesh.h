// The mesh of a file: the room's, closed, cut into objects and simplified as asked for.
#pragma once

#include <cstdint>
#include <vector>

#include "core/image.h"
#include "edit/export/export_options.h"
#include "edit/export/object_meshes.h"

namespace aligngs {

struct ExportMesh {
  std::vector<ObjectMesh> objects;             ///< none of them is empty
  size_t triangles_before = 0, triangles = 0;  ///< of all objects
  double error = 0;             ///< units of the room: how far simplification says that the surface moved
  Image<uint8_t> texture = {};  ///< RGB, sRGB; empty: vertices have the colours
  size_t open_edges = 0;        ///< of all objects together; counted where the mesh is to be closed
};

/// Objects are simplified together, so that no gap opens between them.
ExportMesh export_mesh(const EditableRoom& room, const MeshOptions& options, ThreadPool& pool);

/// JPEG quality of textures: at 90 its errors lie below those of the photos.
inline constexpr int kTextureQuality = 90;

/// How far the surface of a collider may move, as a share of the extent: 1 cm in a room.
inline constexpr double kColliderError = 0.01 / 3;

/// Positions and triangles alone, simplified to the error of `options`, else kColliderError, and further where they say
/// fewer triangles.
ExportMesh collision_mesh(const EditableRoom& room, const MeshOptions& options, ThreadPool& pool);

}  // namespace aligngs
