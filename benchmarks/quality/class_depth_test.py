#!/usr/bin/env python3
"""Tests of the input and the counts of class_depth.py: run it with python3."""
import json
import struct
import tempfile
import unittest
import zlib
from pathlib import Path

import class_depth


def png(width, height, bits, rows):
    """A grey PNG; every row is (filter, bytes)."""
    def chunk(name, body):
        return struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))
    header = struct.pack(">IIBBBBB", width, height, bits, 0, 0, 0, 0)
    data = b"".join(bytes([kind]) + bytes(values) for kind, values in rows)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(data)) + chunk(b"IEND", b"")


def npy(width, height, values):
    header = f"{{'descr': '<f4', 'fortran_order': False, 'shape': ({height}, {width}), }}"
    header += " " * (-(len(header) + 11) % 64) + "\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode() + struct.pack(f"<{len(values)}f", *values)


class ClassDepth(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.scene = Path(self.folder.name)
        self.addCleanup(self.folder.cleanup)

    def write(self, name, data):
        path = self.scene / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
        return path

    def test_every_filter_of_a_png_is_undone(self):
        rows = [(0, [10, 20, 30]), (1, [1, 1, 1]), (2, [1, 1, 1]), (3, [5, 5, 5]), (4, [1, 1, 1])]
        width, height, values = class_depth.read_grey_png(self.write("a.png", png(3, 5, 8, rows)))
        self.assertEqual((width, height), (3, 5))
        self.assertEqual(values, [10, 20, 30, 1, 2, 3, 2, 3, 4, 6, 9, 11, 7, 10, 12])

    def test_sixteen_bits_are_read_whole(self):
        values = class_depth.read_grey_png(self.write("a.png", png(2, 1, 16, [(0, [1, 2, 3, 4])])))[2]
        self.assertEqual(values, [258, 772])

    def test_errors_are_counted_by_the_true_class(self):
        television, wall = class_depth.CLASSES["television"], class_depth.CLASSES["wall"]
        self.write("split.json", json.dumps({"train": ["v"], "test": []}).encode())
        self.write("pred_depths/v.npy", npy(3, 1, [2.4, 3.01, 0]))
        self.write("truth/depth/v.png", png(3, 1, 16, [(0, [7, 208, 11, 184, 11, 184])]))  # 2, 3 and 3 m
        self.write("truth/labels/v.png", png(3, 1, 8, [(0, [television, wall, wall])]))
        on, off = class_depth.errors_of(self.scene, class_depth.SCREENS)["v"]
        self.assertEqual([round(e, 3) for e in on], [0.4])
        self.assertEqual([round(e, 3) for e in off], [0.01])
        self.assertIn("400.0 mm, 0.000 within 5 cm", class_depth.summary(on))

    def test_what_is_no_such_file_is_refused(self):
        with self.assertRaises(ValueError):
            class_depth.read_depth(self.write("a.npy", b"nothing of the kind"))
        with self.assertRaises(ValueError):
            class_depth.read_grey_png(self.write("a.png", png(2, 1, 8, [(0, [1, 2])]).replace(struct.pack(">IIBB", 2, 1, 8, 0), struct.pack(">IIBB", 2, 1, 8, 2))))


if __name__ == "__main__":
    unittest.main()
