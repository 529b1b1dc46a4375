#!/usr/bin/env python3
"""Tests of build_progress.py: python3 scripts/build_progress_test.py"""
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import build_progress
from build_progress import BASE, Progress, in_words, weights


class Estimate(unittest.TestCase):
    def test_the_rest_is_told_by_the_sizes_of_sources(self):
        progress = Progress({"small.o": 1000, "large.o": 3000}, 0)
        self.assertEqual(progress.told("[1/2] Building CXX object small.o", 60), "[1/2, about 3 min left] Building CXX object small.o")

    def test_nothing_is_promised_at_the_start_and_at_the_end(self):
        progress = Progress({"a.o": 1, "b.o": 1}, 0)
        self.assertEqual(progress.told("[1/2] Building CXX object a.o", 5), "[1/2] Building CXX object a.o")
        self.assertEqual(progress.told("[2/2] Building CXX object b.o", 100), "[2/2] Building CXX object b.o")

    def test_other_lines_are_left_alone(self):
        self.assertIsNone(Progress({}, 0).told("src/a.cpp:1: error: no", 20))

    def test_words_for_a_time(self):
        self.assertEqual([in_words(s) for s in (3, 44, 60, 200, 900)], ["10 s", "40 s", "1 min", "3.3 min", "15 min"])


class Weights(unittest.TestCase):
    def test_a_unit_counts_what_it_includes_and_finished_objects_nothing(self):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            (folder / "Unity").mkdir()
            (folder / "a.cpp").write_text("x" * 100)
            (folder / "Unity" / "unity_0.cxx").write_text(f'#include "{folder}/a.cpp"\n#include "{folder}/gone.cpp"\n')
            (folder / "done.o").write_text("")
            commands = [(source, target) for source, target in (("a.cpp", "a.o"), ("a.cpp", "done.o"), ("Unity/unity_0.cxx", "u.o"))]
            (folder / "compile_commands.json").write_text(json.dumps(
                [{"file": str(folder / s), "command": f"c++ -c {s} -o {t} -x"} for s, t in commands]))
            self.assertEqual(weights(folder), {"a.o": BASE + 100, "u.o": BASE + 100})


class Program(unittest.TestCase):
    def test_lines_pass_in_their_order_and_a_missing_folder_is_said(self):
        done = subprocess.run([sys.executable, build_progress.__file__, "/nowhere"], input="[1/1] Linking x\nerror: y\n",
                              capture_output=True, text=True, check=True)
        self.assertEqual(done.stdout, "[1/1] Linking x\nerror: y\n")
        self.assertIn("no estimate", done.stderr)


if __name__ == "__main__":
    unittest.main()
