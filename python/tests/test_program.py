"""The program as a child: with one that stands in for it and, where the variable ALIGNGS names it, with the real one."""
import os
import tempfile
import unittest
from pathlib import Path

import numpy as np

import aligngs
from support import write_fake_program

class Scratch(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.base = Path(scratch.name)


class FakeProgram(Scratch):
    def start(self, source, **more):
        return aligngs.run(source, self.base / "run", program=write_fake_program(self.base), **more)

    def test_events_arrive_in_order_and_the_run_comes_back(self):
        steps = []
        run = self.start("good", on_event=lambda event: steps.append(event["step"]))
        self.assertEqual(steps, [1, 2, 3])
        self.assertTrue(run.done)
        self.assertEqual(len(run.events), 3)

    def test_events_of_an_earlier_run_are_not_told_again(self):
        self.start("good")
        steps = []
        self.start("good", on_event=lambda event: steps.append(event["step"]))
        self.assertEqual(steps, [1, 2, 3])

    def test_a_demo_is_a_run_as_well(self):
        self.assertTrue(aligngs.demo(self.base / "run", program=write_fake_program(self.base)).done)

    def test_an_error_has_the_fields_of_the_program(self):
        with self.assertRaises(aligngs.BadInputError) as raised:
            self.start("bad")
        error = raised.exception
        self.assertEqual((error.message, error.path, error.field, error.remedy, error.status), ("no photos", "/p", "f", "take some", 3))

    def test_every_status_has_its_class(self):
        for status, kind in ((2, aligngs.UsageError), (4, aligngs.WeightsError), (5, aligngs.ResourcesError), (6, aligngs.BelowThresholdError),
                             (75, aligngs.StoppedError), (99, aligngs.FailedError)):
            with self.subTest(status), self.assertRaises(kind) as raised:
                self.start(f"status{status}")
            self.assertEqual(raised.exception.status, status)

    def test_without_json_the_last_line_of_the_log_is_the_message(self):
        with self.assertRaisesRegex(aligngs.FailedError, "it broke"):
            self.start("silent")

    def test_a_killed_program_fails_with_the_signal(self):
        with self.assertRaises(aligngs.FailedError) as raised:
            self.start("killed")
        self.assertEqual(raised.exception.status, 128 + 9)

    def test_a_missing_program_is_an_error_of_its_own(self):
        with self.assertRaises(aligngs.ProgramMissingError):
            aligngs.run("good", self.base / "run", program=self.base / "nothing")


@unittest.skipUnless(os.environ.get("ALIGNGS"), "the variable ALIGNGS names no program")
class RealProgram(Scratch):
    def test_arrays_become_a_scene_and_a_run_and_come_back(self):
        """A wall at a depth of two, seen by cameras that move along it; its left half is of class 0, its right half of class 8."""
        count, height, width = 6, 36, 48
        rng = np.random.default_rng(3)
        wall = np.repeat(np.repeat(rng.integers(40, 220, (height // 4, 40, 3), np.uint8), 4, axis=0), 4, axis=1)
        images = [wall[:, 4 * i:4 * i + width] for i in range(count)]
        poses = [np.eye(4) for _ in range(count)]
        for i, pose in enumerate(poses):
            pose[0, 3] = 4 * i * 2 / 48  # pixels to the side, times depth over focal length
        logits = [np.zeros((150, height, width), np.float32) for _ in range(count)]
        for i, scores in enumerate(logits):
            left = np.arange(width) + 4 * i < 34
            scores[0, :, left] = 9
            scores[8, :, ~left] = 9
        names = [f"photo{i}" for i in range(count)]
        scene = aligngs.Scene(images, aligngs.Intrinsics(48, 48, width / 2, height / 2), poses, depths=[np.full((height, width), 2.0)] * count,
                              logits=logits, names=names, test=["photo2"])
        steps = []
        run = aligngs.run(scene.write(self.base / "scene"), self.base / "run", "-n", "60", "--no-refine",
                          on_event=lambda event: steps.append(event.get("step", 0)))
        self.assertTrue(run.done)
        self.assertEqual(max(steps), 60)
        for camera, pose in zip(run.cameras, poses):
            np.testing.assert_allclose(camera.camera_to_world, pose, atol=1e-9)
        self.assertEqual([c.name for c in run.cameras if c.split == "test"], ["photo2"])
        g = run.gaussians
        np.testing.assert_allclose(np.median(g.positions[:, 2]), 2, atol=0.1)
        np.testing.assert_allclose(np.linalg.norm(g.rotations, axis=1), 1, atol=1e-5)
        self.assertEqual({run.labels.classes[i].id for i in np.unique(run.labels.label)}, {0, 8})
        self.assertGreater(run.metrics["nvs"]["psnr"], 15)
        self.assertLess(int(run.mesh.triangles.max()), len(run.mesh.vertices))

    def test_a_missing_source_is_bad_input(self):
        with self.assertRaisesRegex(aligngs.BadInputError, "no such folder"):
            aligngs.run(self.base / "nothing", self.base / "run")


if __name__ == "__main__":
    unittest.main()
