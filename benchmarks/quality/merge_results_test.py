#!/usr/bin/env python3
"""How results of several places come together: run it with python3."""
import math
import tempfile
import unittest
from pathlib import Path

import ladder_rows
import merge_results

ONE, TWO = ("bedroom", 101, 1), ("bedroom", 101, 2)


def scores(**given):
    return {key: float(given.get(key, math.nan)) for key, *_ in ladder_rows.COLUMNS}


def folder(program, results, **conditions):
    settings = {"programs": [program], "rooms": "test", "iterations": 2000, "size": "320x240", "teacher_seed": None, **conditions}
    return {"settings": {**settings, "rows": {row: {"preset": program} for row in results}}, "results": results}


class MergeTest(unittest.TestCase):
    def setUp(self):
        self.whole = {"settings": {}, "results": {}}

    def test_a_later_part_takes_the_place_of_the_same_pairs(self):
        merge_results.merge(self.whole, folder("old", {"default": {ONE: scores(psnr=20), TWO: scores(psnr=21)}}))
        merge_results.merge(self.whole, folder("new", {"default": {ONE: scores(psnr=25)}}))
        self.assertEqual([self.whole["results"]["default"][k]["psnr"] for k in (ONE, TWO)], [25, 21])
        self.assertEqual(self.whole["settings"]["row programs"], {"default": ["old", "new"]})

    def test_a_program_none_of_whose_pairs_are_left_is_forgotten(self):
        merge_results.merge(self.whole, folder("old", {"default": {ONE: scores()}, "pgsr": {ONE: scores()}}))
        merge_results.merge(self.whole, folder("new", {"default": {ONE: scores(), TWO: scores()}}))
        self.assertEqual(self.whole["settings"]["row programs"], {"default": ["new"], "pgsr": ["old"]})
        self.assertEqual(self.whole["settings"]["programs"], ["new", "old"])
        self.assertEqual(self.whole["settings"]["rows"]["default"], {"preset": "new"})

    def test_parts_that_replace_a_row_only_together_are_merged_first(self):
        old = folder("old", {"default": {ONE: scores(), TWO: scores()}})
        parts = [(str(pair), folder("new", {"default": {pair: scores()}})) for pair in (ONE, TWO)]
        whole = merge_results.put_together([("old", old), ("parts", merge_results.put_together(parts))])
        self.assertEqual(whole["settings"]["row programs"], {"default": ["new"]})

    def test_a_part_that_does_not_fit_is_named(self):
        parts = [("one", folder("old", {"default": {ONE: scores()}})), ("two", folder("old", {"default": {TWO: scores()}}, iterations=1000))]
        with self.assertRaisesRegex(SystemExit, "^two: iterations is 1000"):
            merge_results.put_together(parts)

    def test_other_conditions_do_not_mix(self):
        merge_results.merge(self.whole, folder("old", {"default": {ONE: scores()}}))
        with self.assertRaisesRegex(ValueError, "iterations is 1000"):
            merge_results.merge(self.whole, folder("new", {"default": {TWO: scores()}}, iterations=1000))

    def test_a_capture_is_joined_seed_by_seed(self):
        conditions = {"iterations": 2000, "scale": 0.5}
        for program, seeds in (("old", (1, 2)), ("new", (2, 3))):
            part = {"programs": [program], **conditions, "rows": {"rgb: default": {}}}
            merge_results.merge(self.whole, {"settings": part, "results": {"rgb: default": {(s,): scores(psnr=len(program) + s) for s in seeds}}})
        with tempfile.TemporaryDirectory() as folder:
            merge_results.write_tables(Path(folder), self.whole)
            self.assertIn("| rgb: default | 3 | 5.00 |", (Path(folder) / "table.md").read_text())
            self.assertEqual(len((Path(folder) / "results.csv").read_text().splitlines()), 4)

    def test_a_capture_and_rooms_do_not_mix(self):
        merge_results.merge(self.whole, folder("old", {"default": {ONE: scores()}}))
        with self.assertRaisesRegex(ValueError, "rooms is None"):
            merge_results.merge(self.whole, {"settings": {"programs": ["new"], "iterations": 2000, "scale": 0.5, "rows": {}}, "results": {}})

    def test_tables_of_a_document_stand_between_their_marks(self):
        other = "<!-- other: means -->\nkept\n<!-- other: end -->\n"
        text = "before\n<!-- rooms: means -->\nold\n<!-- rooms: end -->\n" + other
        made = merge_results.with_tables(text, "rooms", {"default": {ONE: scores(psnr=25)}})
        self.assertTrue(made.startswith("before\n<!-- rooms: means -->\n| row | pairs | PSNR |"))
        self.assertTrue(made.endswith("<!-- rooms: end -->\n" + other))
        self.assertIn("| default | 1 | 25.00 |", made)
        self.assertNotIn("old", made)


if __name__ == "__main__":
    unittest.main()
