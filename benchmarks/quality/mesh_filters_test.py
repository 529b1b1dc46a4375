#!/usr/bin/env python3
"""Tests of the files of the benchmark of mesh fusion: run it with python3."""
import math
import tempfile
import unittest
from pathlib import Path

import ladder_rows
import mesh_filters


class MeshFiltersTest(unittest.TestCase):
    def test_thin_classes_count_as_much_as_walls(self):
        metrics = {"geometry": {"fscore": 0.9}, "semantics": {"mesh": {"miou": 0.5, "class_coverage": {"wall": 1.0, "lamp": 0.5, "vase": None}}}}
        found = mesh_filters.scores(metrics)
        self.assertEqual((found["coverage"], found["miou"], found["fscore"]), (0.75, 0.5, 0.9))

    def test_a_scene_without_labels_has_none(self):
        found = mesh_filters.scores({"geometry": {"fscore": 0.9}, "semantics": None})
        self.assertTrue(math.isnan(found["coverage"]) and math.isnan(found["miou"]))

    def test_every_variant_stands_against_the_default(self):
        values = {key: 0.5 for key, *_ in mesh_filters.COLUMNS}
        results = {mesh_filters.DEFAULT: {f"scene {i}": {**values, "fscore": 0.9} for i in range(3)},
                   "plane depth": {f"scene {i}": {**values, "fscore": 0.8} for i in range(3)}}
        with tempfile.TemporaryDirectory() as folder:
            mesh_filters.write_tables(Path(folder), results)
            text = (Path(folder) / "mesh.md").read_text()
            self.assertIn("| 0.800 | 0.500 | 0.50 | 0.50 | 0.5000 | 0.500 | 0.500 | -0.1000 [-0.1000, -0.1000] |", text)
            self.assertEqual(len((Path(folder) / "mesh.csv").read_text().splitlines()), 7)

    def test_names_of_variants_differ(self):
        self.assertEqual(len({name for name, *_ in mesh_filters.VARIANTS}), len(mesh_filters.VARIANTS))
        self.assertEqual(len({ladder_rows.file_name(name) for name, *_ in mesh_filters.VARIANTS}), len(mesh_filters.VARIANTS))


if __name__ == "__main__":
    unittest.main()
