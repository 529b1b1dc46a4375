import tempfile
import unittest
from pathlib import Path

import numpy as np

import aligngs
from support import write_run


class Results(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = write_run(Path(scratch.name) / "run")
        self.run = aligngs.Run(self.folder)

    def test_gaussians_are_what_the_numbers_of_the_file_mean(self):
        g = self.run.gaussians
        self.assertEqual(len(g), 2)
        np.testing.assert_allclose(g.positions, [[1, 2, 3], [2, 2, 3]])
        np.testing.assert_allclose(g.scales[0], np.exp([0, 1, 2]), rtol=1e-6)
        np.testing.assert_allclose(g.opacities, [0.5, 0.5])
        np.testing.assert_allclose(g.rotations[0], [1, 0, 0, 0])

    def test_harmonics_are_channel_major_in_the_file_and_not_here(self):
        sh = self.run.gaussians.sh
        self.assertEqual(sh.shape, (2, 16, 3))
        np.testing.assert_allclose(sh[0, 0], [0.1, 0.2, 0.3], rtol=1e-6)
        np.testing.assert_allclose(sh[0, 1], [0, 15, 30])

    def test_labels_have_classes_objects_and_confidence(self):
        labels = self.run.labels
        self.assertEqual(labels.classes[labels.label[1]].name, "bed")
        self.assertEqual(list(labels.instance), [7, 7])
        np.testing.assert_allclose(labels.confidence, 1)

    def test_a_camera_is_camera_to_world(self):
        camera = self.run.cameras[0]
        np.testing.assert_allclose(camera.camera_to_world @ [1, 0, 0, 1], [1, 3, 3, 1])
        np.testing.assert_allclose(camera.matrix, [[5, 0, 2], [0, 6, 1.5], [0, 0, 1]])
        self.assertEqual(camera.split, "test")

    def test_a_mesh_has_triangles_and_only_the_columns_of_its_file(self):
        mesh = self.run.mesh
        np.testing.assert_array_equal(mesh.triangles, [[0, 1, 2]])
        np.testing.assert_array_equal(mesh.colors[2], [10, 20, 30])
        np.testing.assert_array_equal(mesh.labels, [0, 1, 2])
        self.assertIsNone(mesh.normals)

    def test_parts_that_a_run_lacks_are_none(self):
        self.assertEqual(self.run.metrics["nvs"]["psnr"], 21.5)
        self.assertIsNone(self.run.room)
        (self.folder / "scene.labels.ply").unlink()
        self.assertIsNone(aligngs.Run(self.folder).labels)

    def test_a_folder_without_a_run_is_an_error(self):
        with self.assertRaisesRegex(aligngs.BadInputError, "run.json"):
            aligngs.Run(self.folder / "mesh")

    def test_damaged_files_are_errors_that_name_the_file(self):
        whole = (self.folder / "scene.ply").read_bytes()
        header = whole.index(b"end_header")
        for name, data in (("cut", whole[:-5]), ("no ply", b"x" + whole), ("no header", whole[:40]), ("other property", whole.replace(b"float opacity", b"float opacitx")),
                           ("unknown type", whole.replace(b"property float x\n", b"property flaot x\n")), ("ascii", whole.replace(b"binary_little_endian", b"ascii")),
                           ("count", whole.replace(b"vertex 2", b"vertex -2")), ("no elements", whole[:40] + whole[header:])):
            (self.folder / "scene.ply").write_bytes(data)
            with self.subTest(name), self.assertRaisesRegex(aligngs.BadInputError, "scene.ply"):
                _ = aligngs.Run(self.folder).gaussians


if __name__ == "__main__":
    unittest.main()
