"""The program as a child: with one that stands in for it and, where the variable ALIGNGS names it, with the real one."""
import os
import tempfile
import unittest
from pathlib import Path

import numpy as np

import aligngs
from support import write_fake_program

TINY = ("--size", "48x36", "--views", "6", "-n", "20", "--no-refine")


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
    def test_a_synthetic_room_comes_back_as_arrays_and_its_photos_make_a_scene(self):
        steps = []
        run = aligngs.demo(self.base / "run", *TINY, on_event=lambda event: steps.append(event.get("step", 0)))
        self.assertTrue(run.done)
        self.assertEqual(max(steps), 20)
        g = run.gaussians
        self.assertEqual(len(run.labels.label), len(g))
        np.testing.assert_allclose(np.linalg.norm(g.rotations, axis=1), 1, atol=1e-5)
        self.assertGreater(run.metrics["nvs"]["psnr"], 5)
        self.assertLess(int(run.mesh.triangles.max()), len(run.mesh.vertices))

        # The cameras that the run wrote, with grey photos: written by Scene, read by the program.
        cameras = run.cameras
        images = [np.full((36, 48, 3), 40 * (i + 1), np.uint8) for i in range(len(cameras))]
        intrinsics = [aligngs.Intrinsics(c.fx, c.fy, c.cx, c.cy) for c in cameras]
        depths = [np.full((36, 48), 2.0)] * len(cameras)
        scene = aligngs.Scene(images, intrinsics, [c.camera_to_world for c in cameras], depths=depths, names=[c.name for c in cameras])
        again = aligngs.run(scene.write(self.base / "scene"), self.base / "second", "-n", "5", "--no-refine", "--semantics", "none")
        for ours, theirs in zip(cameras, again.cameras):
            self.assertEqual(ours.name, theirs.name)
            np.testing.assert_allclose(theirs.camera_to_world, ours.camera_to_world, atol=1e-9)

    def test_a_missing_source_is_bad_input(self):
        with self.assertRaisesRegex(aligngs.BadInputError, "no such folder"):
            aligngs.run(self.base / "nothing", self.base / "run")


if __name__ == "__main__":
    unittest.main()
