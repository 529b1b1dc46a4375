#!/usr/bin/env python3
"""Tests of room_accuracy.py: fits, overlaps and matches of things with known answers."""
import math
import unittest

import room_accuracy as r

IDENTITY = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]


def room(width=4, depth=3, height=2.5, shift=0.0):
    corners = [[0, 0], [width, 0], [width, depth], [0, depth]]
    walls = []
    for i, normal in enumerate(([0, 1], [-1, 0], [0, -1], [1, 0])):
        a, b = corners[i], corners[(i + 1) % 4]
        walls.append({"id": f"wall.{i + 1}", "from": [a[0] + shift, a[1]], "to": [b[0] + shift, b[1]], "length": math.dist(a, b),
                      "plane": normal + [0, -(normal[0] * (a[0] + shift) + normal[1] * a[1])]})
    return {"walls": walls, "openings": [], "objects": [], "frame": {"world_to_room": IDENTITY + [[0, 0, 0, 1]]}}


def window(left, right, kind="window"):
    return {"kind": kind, "wall": "wall.1", "left": left, "right": right, "sill": 1, "top": 2,
            "outline": [[left, 0, 1], [right, 0, 1], [right, 0, 2], [left, 0, 2]]}


def box(x, name="sofa", size=(2, 1, 1), turn=0):
    return {"class": name, "centre": [x, 1, 0.5], "size": list(size), "turn": turn}


class RoomAccuracy(unittest.TestCase):
    here = staticmethod(lambda p: p)

    def test_a_motion_is_found_from_points(self):
        rotation, shift = r.rotation_of([math.cos(0.4), 0, math.sin(0.4), 0]), [1, -2, 3]
        source = [[0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]]
        motion, scale = r.rigid_fit(source, [r.add(r.apply(rotation, p), shift) for p in source])
        self.assertAlmostEqual(scale, 1)
        for row, expected in zip(motion, rotation):
            for a, b in zip(row, expected):
                self.assertAlmostEqual(a, b, places=6)

    def test_walls_that_moved_are_off_by_so_much(self):
        positions, lengths = r.wall_errors(room(shift=0.02), room(), self.here)
        self.assertEqual([round(p, 6) for p in positions], [0, 0.02, 0, 0.02])
        self.assertEqual([round(x, 6) for x in lengths], [0, 0, 0, 0])

    def test_a_missing_wall_is_infinitely_wrong(self):
        measured = room()
        measured["walls"] = measured["walls"][:3]
        self.assertEqual(r.wall_errors(measured, room(), self.here)[0][3], math.inf)

    def test_openings_match_once_and_by_kind(self):
        truth, measured = room(), room()
        truth["openings"] = [window(1, 2), window(2.5, 3, "picture")]
        measured["openings"] = [window(1.05, 2), window(1, 2.4), window(2.5, 3, "mirror")]
        true, found, edges = r.match_openings(measured, truth, self.here, r.HOLES)
        self.assertEqual((true, found, len(edges)), (1, 2, 1))
        self.assertAlmostEqual(edges[0][0], 0.05)
        self.assertEqual(len(r.match_openings(measured, truth, self.here, r.HOLES + ("picture", "mirror"))[2]), 2)

    def test_a_box_turned_by_a_right_angle_is_the_same(self):
        a, b = r.footprint(box(1), self.here), r.footprint(box(1, size=(1, 2, 1), turn=90), self.here)
        self.assertAlmostEqual(r.box_iou(a, b), 1)

    def test_boxes_half_beside_each_other_overlap_by_a_third(self):
        self.assertAlmostEqual(r.box_iou(r.footprint(box(1), self.here), r.footprint(box(2), self.here)), 1 / 3)

    def test_boxes_of_another_class_match_without_class_alone(self):
        truth, measured = {"objects": [box(1)]}, {"objects": [box(1, "bench")]}
        self.assertEqual(r.match_boxes(measured, truth, self.here, True)[2], [])
        self.assertEqual(len(r.match_boxes(measured, truth, self.here, False)[2]), 1)

    def test_nothing_measured_is_no_error(self):
        self.assertEqual(r.match_boxes({"objects": []}, {"objects": [box(1)]}, self.here, True), (1, 0, [], []))


if __name__ == "__main__":
    unittest.main()
