#!/usr/bin/env python3
"""Tests of room_planes.py: planes of meshes with known answers. They skip (77) without Debian's python3-numpy."""
import sys
import tempfile
import unittest
from pathlib import Path

try:
    import numpy as np

    import room_planes as p
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)


def sheet(origin, u, v, count=40):
    """A square grid of triangles."""
    origin, u, v = (np.array(x, float) for x in (origin, u, v))
    s = np.linspace(0, 1, count)
    vertices = np.array([origin + a * u + b * v for a in s for b in s])
    corner = np.array([i * count + j for i in range(count - 1) for j in range(count - 1)])
    triangles = np.concatenate([np.stack([corner, corner + 1, corner + count], 1), np.stack([corner + 1, corner + count + 1, corner + count], 1)])
    return vertices, triangles


def joined(*meshes):
    vertices, triangles, first = [], [], 0
    for v, t in meshes:
        vertices.append(v)
        triangles.append(t + first)
        first += len(v)
    return np.concatenate(vertices), np.concatenate(triangles)


def room(width=4, depth=3, height=2.5):
    corners = [[0, 0], [width, 0], [width, depth], [0, depth]]
    walls = []
    for i, normal in enumerate(([0, 1], [-1, 0], [0, -1], [1, 0])):
        a, b = corners[i], corners[(i + 1) % 4]
        walls.append({"id": f"wall.{i + 1}", "from": a, "to": b, "height": height, "assumed": False,
                      "plane": normal + [0, -(normal[0] * a[0] + normal[1] * a[1])]})
    return {"walls": walls, "measures": {"ceiling_height": height}, "floor": {"assumed": False}, "ceiling": {"assumed": False}}


FLOOR, CEILING = sheet([0, 0, 0], [4, 0, 0], [0, 3, 0]), sheet([0, 0, 2.53], [4, 0, 0], [0, 3, 0])
WALL = sheet([0, 0.02, 0], [4, 0, 0], [0, 0, 2.5])  # that of y = 0, 2 cm in the room


class RoomPlanes(unittest.TestCase):
    def results(self, *meshes):
        return p.compare(room(), p.surfaces_of(*joined(*meshes)))

    def test_a_wall_is_off_by_the_distance_of_its_plane(self):
        result = self.results(FLOOR, WALL)["wall.1"]
        self.assertAlmostEqual(result["distance"], 0.02, places=3)
        self.assertLess(result["angle"], 0.1)
        self.assertAlmostEqual(result["behind"], 0)

    def test_the_height_is_off_by_that_of_the_ceiling(self):
        results = self.results(FLOOR, CEILING)
        self.assertAlmostEqual(results["floor"]["distance"] + results["ceiling"]["distance"], -0.03, places=3)

    def test_a_surface_that_the_mesh_does_not_show_has_no_distance(self):
        self.assertIsNone(self.results(FLOOR)["wall.2"]["distance"])

    def test_things_before_a_wall_do_not_move_its_plane(self):
        cupboard = sheet([1, 0.2, 0], [1, 0, 0], [0, 0, 1])
        self.assertAlmostEqual(self.results(WALL, cupboard)["wall.1"]["distance"], 0.02, places=3)

    def test_what_lies_behind_a_wall_is_told(self):
        beyond = sheet([0, -0.6, 0], [4, 0, 0], [0, 0, 2.5])
        result = self.results(WALL, beyond)["wall.1"]
        self.assertAlmostEqual(result["behind"], 10, delta=1)
        self.assertAlmostEqual(result["distance"], 0.02, places=3)

    def test_a_binary_mesh_is_read(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "mesh.ply"
            header = ("ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                      "property uchar red\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n")
            vertices = np.zeros(3, [("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("red", "u1")])
            vertices["x"] = [1, 2, 3]
            path.write_bytes(header.encode() + vertices.tobytes() + b"\x03" + np.array([0, 1, 2], "<i4").tobytes())
            points, triangles = p.read_mesh(path)
        self.assertEqual(points[:, 0].tolist(), [1, 2, 3])
        self.assertEqual(triangles.tolist(), [[0, 1, 2]])


if __name__ == "__main__":
    unittest.main()
