#!/usr/bin/env python3
"""Tests of the files of the benchmark of a real capture: run it with python3."""
import json
import tempfile
import unittest
from pathlib import Path
from types import SimpleNamespace

import capture
import ladder
from ladder_test import scores


class CaptureTest(unittest.TestCase):
    def table(self, results):
        with tempfile.TemporaryDirectory() as folder:
            capture.write_tables(SimpleNamespace(output=Path(folder), iterations=2000, scale=0.5), results)
            return (Path(folder) / "table.md").read_text()

    def test_rows_that_need_labels_are_empty_and_say_why(self):
        text = self.table({"rgb: default": {(1,): scores(psnr=25)}})
        row = next(line for line in text.splitlines() if line.startswith("| rgb: + L_sem, coupled |"))
        self.assertEqual(set(row.split(" | ")[2:]), {"–", "– |"})
        self.assertIn(capture.WHY_EMPTY, text)

    def test_rows_are_compared_with_those_of_their_own_source(self):
        for row in capture.ROWS:
            for base in row.compare_with:
                self.assertEqual(base.split(":")[0], row.source)
                self.assertIn(base, [r.name for r in capture.ROWS])

    def test_differences_are_paired_by_seed(self):
        text = self.table({"rgb: default": {(s,): scores(psnr=25 + s) for s in (1, 2, 3)}, "rgb: pgsr": {(s,): scores(psnr=23 + s) for s in (1, 2, 3)}})
        self.assertIn("| rgb: default | rgb: pgsr | +2.00 [+2.00, +2.00] | – | – |", text)

    def test_settings_of_another_length_are_refused_and_programs_are_kept(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "settings.json"
            file.write_text(json.dumps({"programs": ["another"], "iterations": 2000}))
            version, ladder.program_version = ladder.program_version, lambda device: "this one"
            try:
                ladder.write_settings(Path(folder), {"iterations": 2000}, {})
                self.assertEqual(json.loads(file.read_text())["programs"], ["another", "this one"])
                with self.assertRaises(SystemExit):
                    ladder.write_settings(Path(folder), {"iterations": 3000}, {})
            finally:
                ladder.program_version = version


if __name__ == "__main__":
    unittest.main()
