"""Tests of objects.py's arithmetic."""
import unittest

from objects import scores, table


def row(way, truths, found, right, room="bedroom 1"):
    return {"room": room, "draw": 1, "way": way, "truths": truths, "found": found, "right": right, "mean_iou": 0.5}


class Objects(unittest.TestCase):
    def test_counts_of_several_rooms_are_added_first(self):
        precision, recall, fscore, _ = scores([row("votes", 10, 5, 5), row("votes", 10, 15, 5)])
        self.assertAlmostEqual(precision, 0.5)
        self.assertAlmostEqual(recall, 0.5)
        self.assertAlmostEqual(fscore, 0.5)

    def test_nothing_found_is_zero(self):
        self.assertEqual(scores([row("votes", 4, 0, 0)])[:3], (0.0, 0.0, 0.0))

    def test_the_last_line_is_of_all_rooms(self):
        rows = [row(way, 10, 10, right, room) for way, right in (("connected", 4), ("votes", 6)) for room in ("bedroom 1", "living 1")]
        lines = table(rows)
        self.assertEqual(len(lines), 5)
        self.assertTrue(lines[-1].startswith("| all | 2 | 20 | 0.400 | 0.600 |"))


if __name__ == "__main__":
    unittest.main()
