#!/usr/bin/env python3
"""Tests of the ladder's numbers: run it with python3."""
import math
import tempfile
import unittest
from pathlib import Path
from types import SimpleNamespace

import ladder
import ladder_rows
import ladder_tables


def scores(**given):
    return {key: float(given.get(key, math.nan)) for key, *_ in ladder_rows.COLUMNS}


class LadderTest(unittest.TestCase):
    def test_interval_of_equal_differences_is_that_difference(self):
        self.assertEqual(ladder_tables.interval({("a", 1): 0.5, ("a", 2): 0.5, ("b", 1): 0.5}), (0.5, 0.5, 0.5, 3))

    def test_interval_ignores_what_is_not_known(self):
        middle, low, high, count = ladder_tables.interval({("a", 1): 1.0, ("a", 2): math.nan, ("b", 1): 3.0})
        self.assertEqual((middle, count), (2.0, 2))
        self.assertTrue(1.0 <= low <= high <= 3.0)
        self.assertEqual(ladder_tables.interval({})[3], 0)

    def test_draws_of_one_room_are_not_as_many_rooms(self):
        rooms_differ = {(room, seed): value for room, value in (("a", 0.0), ("b", 1.0)) for seed in range(20)}
        draws_differ = {(room, seed): float(seed % 2) for room in "ab" for seed in range(20)}
        self.assertEqual(ladder_tables.interval(rooms_differ)[1:3], (0.0, 1.0))
        middle, low, high, _ = ladder_tables.interval(draws_differ)
        self.assertTrue(0.2 < low < middle < high < 0.8)

    def test_an_interval_that_holds_zero_is_called_noise(self):
        results = {"a": {("room", i): scores(psnr=20 + d) for i, d in enumerate((-1, 0, 1, 2))},
                   "b": {("room", i): scores(psnr=20) for i in range(4)}, "c": {("room", i): scores(psnr=10) for i in range(4)}}
        self.assertIn("(noise)", ladder_tables.difference_cell(results, "a", "b", "psnr", 2))
        self.assertNotIn("(noise)", ladder_tables.difference_cell(results, "a", "c", "psnr", 2))
        self.assertEqual(ladder_tables.difference_cell(results, "a", "b", "fscore", 3), "–")

    def test_equal_results_are_called_the_same(self):
        results = {name: {("room", i): scores(psnr=20 + i) for i in range(4)} for name in "ab"}
        self.assertEqual(ladder_tables.difference_cell(results, "a", "b", "psnr", 2), "0 (the same to the last digit)")

    def test_labels_without_meaning_are_not_compared(self):
        key = ("bedroom", 101, 1)
        results = {name: {key: scores(psnr=20, miou=0.5)} for name in ("default, refined", "stereo, uncoupled", "default, refined, shuffled labels")}
        lines = ladder_tables.difference_lines(results)
        self.assertTrue(next(l for l in lines if "| default, refined | default, refined, shuffled labels |" in l).endswith("| – |"))
        self.assertFalse(next(l for l in lines if "| default, refined | stereo, uncoupled |" in l).endswith("| – |"))

    def test_two_pairs_are_noise_whatever_they_say(self):
        results = {"a": {("room", i): scores(psnr=30) for i in range(2)}, "b": {("room", i): scores(psnr=20) for i in range(2)}}
        self.assertIn("(noise)", ladder_tables.difference_cell(results, "a", "b", "psnr", 2))

    def test_a_mean_of_some_says_of_how_many(self):
        self.assertEqual(ladder_tables.mean_cell([1.0, math.nan, 3.0], 1), "2.0 (of 2)")
        self.assertEqual(ladder_tables.mean_cell([1.0, 3.0], 1), "2.0")
        self.assertEqual(ladder_tables.mean_cell([math.nan], 1), "–")

    def test_a_number_of_a_list_is_found_by_its_protocol(self):
        document = {"variants": [{"protocol": "area_samples, all poses, alignment: none", "fscore": 0.5},
                                 {"protocol": "area_samples, training poses, alignment: none", "fscore": 0.6}]}
        self.assertEqual(ladder.value_at(document, "variants.area_samples, training poses.fscore"), 0.6)
        self.assertTrue(math.isnan(ladder.value_at(document, "variants.neuris_vertices.fscore")))

    def test_results_are_read_as_they_were_written(self):
        key = ("bedroom", 101, 2)
        results = {"default, refined": {key: scores(psnr=25.5, fscore=0.9)}}
        with tempfile.TemporaryDirectory() as folder:
            ladder_tables.write_tables(SimpleNamespace(output=Path(folder), rooms="test", iterations=2000, size="320x240"), results)
            again = ladder_tables.read_csv(Path(folder) / "results.csv", ladder_rows.PAIR)
        self.assertEqual(again["default, refined"][key]["psnr"], 25.5)
        self.assertTrue(math.isnan(again["default, refined"][key]["ssim"]))

    def test_acceptance_is_summed_up_over_scenes(self):
        with tempfile.TemporaryDirectory() as folder:
            for name, value, verdict in (("a", "4.0", "ok"), ("b", "5.0", "outside")):
                (Path(folder) / f"{name}.txt").write_text(
                    f"room\n  point accuracy mean                   {value} cm   3 to 4.5       {verdict}\n  focal error    0.8 %    -              \n")
            lines = ladder_tables.acceptance_lines(Path(folder))
            self.assertEqual(lines[-1], "| point accuracy mean | 4.500 cm | 3 to 4.5 | 1 of 2 |")
            self.assertEqual(ladder_tables.acceptance_lines(Path(folder) / "none"), [])

    def test_share_of_the_way_from_the_prior_to_the_ceiling(self):
        first, *_, last = ladder_rows.YARDSTICKS["default, refined"]
        key = ("bedroom", 101, 1)
        results = {"default, refined": {key: scores(fscore=0.9)}, first.name: {key: scores(fscore=0.7)},
                   last.name: {key: scores(fscore=1.0)}}
        self.assertIn("0.67 [0.67, 0.67], smallest 0.67", "\n".join(ladder_tables.gap_lines(results)))

    def test_rows_with_more_pairs_stand_once_more_on_those_of_shorter_rows(self):
        few, many = ("bedroom", 101, 1), ("bedroom", 101, 2)
        short = {few: scores(fscore=0.5)}
        lines = ladder_tables.common_lines({"a": short, "b": short, "c": {few: scores(fscore=0.8), many: scores(fscore=0.6)}})
        self.assertEqual(len(lines), 1)
        self.assertIn("| c, the pairs of shorter rows | 1 |", lines[0])
        self.assertIn(" 0.800 ", lines[0])
        whole = {few: scores(), many: scores()}
        self.assertEqual(len(ladder_tables.common_lines({"a": short, "b": whole, "c": whole})), 2)
        self.assertEqual(ladder_tables.common_lines({"a": short, "b": short, "c": {many: scores()}}), [])
        self.assertEqual(ladder_tables.common_lines({}), [])

    def test_every_room_has_its_mean(self):
        line = ladder_tables.summary_line("gain", {("office", 104, 1): 0.02, ("office", 104, 2): 0.04, ("bedroom", 101, 1): -0.01}, 3)
        self.assertIn("smallest -0.010, over 3 pairs (bedroom -0.010, office 0.030).", line)

    def test_differences_stand_room_by_room(self):
        def room(name, psnr, f):
            return {(name, 1, 1): scores(psnr=psnr, fscore=f)}
        results = {"base": {**room("bedroom", 20, 0.5), **room("office", 21, 0.6)}, "better": {**room("bedroom", 21, 0.6), **room("office", 20.5, 0.6)},
                   "a mesh": {("bedroom", 1, 1): scores(fscore=0.9)}}
        head, _, *lines = ladder_tables.room_lines(results, "base")
        self.assertIn("PSNR: bedroom, office", head)
        self.assertEqual(len(lines), 1)  # the base is not compared with itself, nor a mesh with a picture
        self.assertTrue(lines[0].startswith("| better | 2 |"))
        self.assertTrue(lines[0].endswith("| +1.00, -0.50 | +0.100, +0.000 |"))

    def test_coupling_is_compared_with_the_best_placebo_of_each_pair(self):
        keys = [("bedroom", 101, s) for s in (1, 2, 3)]
        results = {ladder_rows.COUPLED: {k: scores(fscore=0.8, psnr=25) for k in keys}}
        for i, placebo in enumerate(ladder_rows.PLACEBOS):
            results[placebo] = {k: scores(fscore=0.7 + 0.05 * i, psnr=24) for k in keys}
        self.assertIn("-0.000 [-0.000, -0.000]", "\n".join(ladder_tables.gap_lines(results)).replace("+0.000", "-0.000"))

    def test_every_row_that_is_compared_with_exists(self):
        names = {row.name for row in ladder_rows.ROWS}
        self.assertEqual(len(names), len(ladder_rows.ROWS))
        names |= set(ladder_rows.FUSED_AS_DEFAULT.values())
        for row in ladder_rows.ROWS:
            self.assertTrue(set(row.compare_with) <= names, row.name)
        self.assertTrue({*ladder_rows.CONTROLS, *sum(ladder_rows.CONTROLS.values(), []), *ladder_rows.YARDSTICKS} <= names)

    def test_a_start_from_depth_has_depth(self):
        for row in ladder_rows.ROWS:
            self.assertFalse({"init.start=depth", "data.prior_depth=none"} <= set(row.settings), row.name)


if __name__ == "__main__":
    unittest.main()
