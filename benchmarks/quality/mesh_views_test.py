"""Tests of mesh_views.py: python3 mesh_views_test.py. They skip (77) without Debian's python3-numpy and python3-pil."""
import io
import json
import struct
import sys
import tempfile
import unittest
from pathlib import Path

try:
    import numpy as np
    from PIL import Image

    import mesh_views
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)


def glb(folder, corners, triangles, uv, picture):
    """A GLB of one textured mesh."""
    buffer, views, accessors = b"", [], []

    def add(data):
        nonlocal buffer
        views.append({"buffer": 0, "byteOffset": len(buffer), "byteLength": len(data)})
        buffer += data + b"\0" * (-len(data) % 4)
        return len(views) - 1
    for values, component, kind in ((np.float32(corners), 5126, "VEC3"), (np.float32(uv), 5126, "VEC2"), (np.uint32(triangles).reshape(-1), 5125, "SCALAR")):
        accessors.append({"bufferView": add(values.tobytes()), "componentType": component, "count": len(values), "type": kind})
    file = io.BytesIO()
    Image.fromarray(picture).save(file, "PNG")
    document = {"bufferViews": views, "accessors": accessors, "images": [{"bufferView": add(file.getvalue())}],
                "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2}]}]}
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    path = Path(folder) / "room.glb"
    path.write_bytes(struct.pack("<4sIIII", b"glTF", 2, 28 + len(text) + len(buffer), len(text), 0x4E4F534A) + text + struct.pack("<II", len(buffer), 0x4E4942) + buffer)
    return path


class MeshViews(unittest.TestCase):
    def setUp(self):
        self.picture = np.zeros((64, 64, 3), np.uint8)
        self.picture[:, 32:] = (255, 0, 0)
        self.picture[32:, :32] = (0, 255, 0)

    def drawn(self, corners, **options):
        with tempfile.TemporaryDirectory() as folder:
            mesh = mesh_views.Mesh(glb(folder, corners, [[0, 1, 2], [0, 2, 3]], [[0, 0], [1, 0], [1, 1], [0, 1]], self.picture))
        return mesh_views.draw(mesh, np.eye(3), np.zeros(3), 100, 100, 50, 50, 100, 100, **options)

    def test_a_square_before_the_camera_shows_its_texture(self):
        drawn = self.drawn([[-1, -1, 2], [1, -1, 2], [1, 1, 2], [-1, 1, 2]])
        self.assertTrue(np.allclose(drawn[10, 70], (1, 0, 0)))
        self.assertTrue(np.allclose(drawn[80, 20], (0, 1, 0)))
        self.assertTrue(np.allclose(drawn[20, 20], (0, 0, 0)))

    def test_a_slanted_square_is_drawn_in_perspective(self):
        # The middle of the texture is at z = 2 and x = 0; the far edge at z = 3.
        drawn = self.drawn([[-1, -1, 1], [1, -1, 3], [1, 1, 3], [-1, 1, 1]])
        self.assertTrue(np.allclose(drawn[48, 53], (1, 0, 0)))
        self.assertTrue(np.allclose(drawn[52, 47], (0, 1, 0), atol=0.2))
        self.assertEqual(drawn[48, 85].sum(), 0)

    def test_a_floor_that_passes_the_camera_is_cut(self):
        drawn = self.drawn([[-1, 0.5, -2], [1, 0.5, -2], [1, 0.5, 4], [-1, 0.5, 4]])
        self.assertGreater(drawn[90, 20].sum(), 0.9)
        self.assertEqual(drawn[40].sum(), 0)

    def test_what_is_above_the_cut_is_left_out(self):
        drawn = self.drawn([[-1, -1, 2], [1, -1, 2], [1, 1, 2], [-1, 1, 2]], below=2.5)
        self.assertEqual(drawn.sum(), 0)


if __name__ == "__main__":
    unittest.main()
