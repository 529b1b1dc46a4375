import json
import tempfile
import unittest
from pathlib import Path

import numpy as np

import aligngs
from aligngs.scene import _quaternion
from support import scene_arrays

CAMERA = aligngs.Intrinsics(7, 7, 4, 3)


class WriteScene(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name) / "scene"
        self.images, self.poses = scene_arrays()

    def scene(self, **more):
        return aligngs.Scene(self.images, CAMERA, self.poses, **more)

    def test_the_folder_has_photos_cameras_and_a_split(self):
        self.scene(test=["0002"]).write(self.folder)
        self.assertEqual(json.loads((self.folder / "split.json").read_text()), {"train": ["0000", "0001"], "test": ["0002"]})
        self.assertEqual((self.folder / "sparse" / "cameras.txt").read_text().splitlines()[0], "1 PINHOLE 8 6 7 7 4 3")
        second = (self.folder / "sparse" / "images.txt").read_text().split("\n\n")[1].split()
        self.assertEqual(second[0], "2")
        np.testing.assert_allclose([float(n) for n in second[1:8]], [1, 0, 0, 0, -1, 0, 0], atol=1e-12)  # world to camera
        self.assertFalse((self.folder / "priors.json").exists())

    def test_priors_are_arrays_with_their_meaning_beside_them(self):
        depths = [np.full((3, 4), i + 1.0) for i in range(3)]
        self.scene(depths=depths, logits=[np.zeros((5, 3, 4))] * 3, logits_kind="scores", depth_scale="metres").write(self.folder)
        np.testing.assert_allclose(np.load(self.folder / "pred_depths" / "0001.npy"), depths[1])
        priors = json.loads((self.folder / "priors.json").read_text())
        self.assertEqual((priors["depth"]["scale"], priors["semantics"]["kind"]), ("metres", "scores"))

    def test_a_folder_of_somebody_else_is_never_replaced(self):
        self.folder.mkdir()
        (self.folder / "notes.txt").write_text("mine")
        with self.assertRaises(aligngs.UsageError):
            self.scene().write(self.folder, overwrite=True)
        self.assertEqual([p.name for p in self.folder.iterdir()], ["notes.txt"])

    def test_its_own_folder_is_replaced_when_asked(self):
        self.scene().write(self.folder)
        with self.assertRaises(aligngs.UsageError):
            self.scene().write(self.folder)
        self.scene(names=["a", "b", "c"]).write(self.folder, overwrite=True)
        self.assertEqual(sorted(p.name for p in (self.folder / "images").iterdir()), ["a.png", "b.png", "c.png"])

    def test_wrong_arrays_are_named(self):
        turned = [np.diag([1, -1, 1, 1.0])] * 3
        for field, make in (("images\\[0\\]", lambda: aligngs.Scene([i.astype(float) for i in self.images], CAMERA, self.poses)),
                            ("images", lambda: aligngs.Scene(self.images[:1], CAMERA, self.poses[:1])),
                            ("poses\\[0\\]", lambda: aligngs.Scene(self.images, CAMERA, turned)),
                            ("poses: has 2", lambda: aligngs.Scene(self.images, CAMERA, self.poses[:2])),
                            ("depths\\[0\\]", lambda: self.scene(depths=[np.zeros(3)] * 3)),
                            ("names", lambda: self.scene(names=["a", "a", "b"])),
                            ("names", lambda: self.scene(names=["../a", "b", "c"])),
                            ("test", lambda: self.scene(test=["9"])),
                            ("depth_scale", lambda: self.scene(depth_scale="feet"))):
            with self.subTest(field), self.assertRaisesRegex(aligngs.UsageError, field):
                make()

    def test_arrays_that_would_mean_something_else_are_refused(self):
        third, depth = [p.T for p in self.poses], np.ones((6, 8))
        third[0] = np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [1, 2, 3, 1.0]])
        for words, make in (("poses\\[0\\]: is transposed", lambda: aligngs.Scene(self.images, CAMERA, third)),
                            ("depths\\[0\\]: is bool", lambda: self.scene(depths=[depth > 0] * 3)),
                            ("depths\\[0\\]: is complex", lambda: self.scene(depths=[depth + 0j] * 3)),
                            ("confidences", lambda: self.scene(confidences=[depth] * 3)),
                            ("colors must be integers", lambda: self.scene(points=aligngs.Points(np.ones((4, 3)), np.ones((4, 3))))),
                            ("positions must be finite", lambda: self.scene(points=aligngs.Points(np.full((4, 3), np.nan), np.ones((4, 3), np.uint8)))),
                            ("intrinsics", lambda: aligngs.Scene(self.images, aligngs.Intrinsics(-7, 7, 4, 3), self.poses)),
                            ("intrinsics: is int", lambda: aligngs.Scene(self.images, (7, 7, 4), self.poses)),
                            ("test: is one text", lambda: self.scene(test="0002"))):
            with self.assertRaisesRegex(aligngs.UsageError, words):
                make()

    def test_a_linked_folder_is_replaced_where_it_lies(self):
        self.scene().write(self.folder)
        link = self.folder.with_name("link")
        link.symlink_to(self.folder)
        self.scene(names=["a", "b", "c"]).write(link, overwrite=True)
        self.assertTrue((self.folder / "images" / "a.png").exists())
        self.assertEqual(sorted(p.name for p in self.folder.parent.iterdir()), ["link", "scene"])

    def test_quaternions_turn_as_their_matrices(self):
        rng = np.random.default_rng(2)
        for _ in range(50):
            w, x, y, z = q = (lambda v: v / np.linalg.norm(v))(rng.normal(size=4))
            matrix = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                               [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                               [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
            np.testing.assert_allclose(_quaternion(matrix), q * (1 if w >= 0 else -1), atol=1e-9)


if __name__ == "__main__":
    unittest.main()
