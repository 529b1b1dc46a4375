#!/usr/bin/env python3
"""Compares room.json of runs with the truth of their synthetic rooms.

    benchmarks/quality/room_accuracy.py RUN TRUTH [RUN TRUTH...]      a Markdown table

RUN is a run folder with room.json. TRUTH is a scene folder of `aligngs synth` of the same room and seed, with truth/room.json. The
world of the run is aligned to the true one by the training cameras of RUN/sparse and SCENE/truth/sparse. Scale is not aligned, so its
error counts. SCENE is the scene of the run."""
import json
import math
import struct
import sys
from pathlib import Path

LEAST_BOX = 0.25     # metres: the program leaves out smaller furniture
OPENING_IOU = 0.3    # of two rectangles on one wall that are the same thing
HOLES = ("door", "window")


# ---- vectors ----
def add(a, b): return [x + y for x, y in zip(a, b)]
def sub(a, b): return [x - y for x, y in zip(a, b)]
def scaled(a, s): return [x * s for x in a]
def dot(a, b): return sum(x * y for x, y in zip(a, b))
def norm(a): return math.sqrt(dot(a, a))
def apply(rows, v): return [dot(row[:3], v) + (row[3] if len(row) > 3 else 0) for row in rows]
def transposed(m): return [list(row) for row in zip(*m)]
def median(values): return sorted(values)[len(values) // 2] if values else float("nan")


def rotation_of(q):
    w, x, y, z = q
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]


def camera_centres(folder):
    """Name to centre, from images.bin of a COLMAP model."""
    data, at, centres = (Path(folder) / "images.bin").read_bytes(), 8, {}
    for _ in range(struct.unpack_from("<Q", data)[0]):
        pose = struct.unpack_from("<7d", data, at + 4)
        end = data.index(b"\0", at + 64)
        name = data[at + 64:end].decode()
        points = struct.unpack_from("<Q", data, end + 1)[0]
        at = end + 9 + 24 * points
        centres[name] = apply(transposed(rotation_of(pose[:4])), scaled(pose[4:], -1))
    return centres


def rigid_fit(source, target):
    """Rows of the 3 x 4 motion from source to target points (Horn 1987), and the scale that would fit best."""
    a, b = ([scaled([sum(axis) for axis in zip(*points)], 1 / len(points))][0] for points in (source, target))
    p, q = [sub(x, a) for x in source], [sub(x, b) for x in target]
    s = [[sum(x[i] * y[j] for x, y in zip(p, q)) for j in range(3)] for i in range(3)]
    n = [[s[0][0] + s[1][1] + s[2][2], s[1][2] - s[2][1], s[2][0] - s[0][2], s[0][1] - s[1][0]],
         [s[1][2] - s[2][1], s[0][0] - s[1][1] - s[2][2], s[0][1] + s[1][0], s[2][0] + s[0][2]],
         [s[2][0] - s[0][2], s[0][1] + s[1][0], s[1][1] - s[0][0] - s[2][2], s[1][2] + s[2][1]],
         [s[0][1] - s[1][0], s[2][0] + s[0][2], s[1][2] + s[2][1], s[2][2] - s[0][0] - s[1][1]]]
    shift = sum(abs(x) for row in n for x in row)  # makes the greatest eigenvalue the one of greatest size
    v = [1.0, 0.1, 0.1, 0.1]
    for _ in range(20000):
        w = [dot(row, v) + shift * x for row, x in zip(n, v)]
        w = scaled(w, 1 / norm(w))
        if norm(sub(w, v)) < 1e-14:
            break
        v = w
    rotation = rotation_of(v)
    scale = math.sqrt(sum(dot(y, y) for y in q) / sum(dot(x, x) for x in p))
    return [row + [t] for row, t in zip(rotation, sub(b, apply(rotation, a)))], scale


# ---- geometry of rooms ----
def inverse(rows):
    """The inverse of a similarity given by four rows."""
    linear = [row[:3] for row in rows[:3]]
    square = dot(linear[0], linear[0])
    back = [scaled(row, 1 / square) for row in transposed(linear)]
    return [row + [-dot(row, [r[3] for r in rows[:3]])] for row in back]


def placed(room, motion, truth):
    """A function from the room's frame to that of the true room."""
    to_world, to_truth = inverse(room["frame"]["world_to_room"]), truth["frame"]["world_to_room"][:3]
    return lambda p: apply(to_truth, apply(motion, apply(to_world, p)))


def wall_errors(room, truth, place):
    """For each true wall, at its quarter points, the distance of the nearest measured wall that faces the same way; and the error of its length."""
    walls = []
    for wall in room["walls"]:
        a, b = place(wall["from"] + [0]), place(wall["to"] + [0])
        length = math.dist(a[:2], b[:2])
        walls.append((a, b, [-(b[1] - a[1]) / length, (b[0] - a[0]) / length], length))
    positions, lengths = [], []
    for true in truth["walls"]:
        best = None
        for a, b, normal, length in walls:
            if dot(normal, true["plane"][:2]) < 0.9:
                continue
            error = sum(abs(dot(normal, sub(add(scaled(true["from"], 1 - t), scaled(true["to"], t)), a[:2]))) for t in (0.25, 0.75)) / 2
            if best is None or error < best[0]:
                best = (error, length)
        positions.append(best[0] if best else float("inf"))
        lengths.append(abs(best[1] - true["length"]) if best else float("inf"))
    return positions, lengths


def rectangle_on(wall, opening, place):
    """[left, right, bottom, top] of an opening on a true wall."""
    a, b = wall["from"], wall["to"]
    along = scaled(sub(b, a), 1 / wall["length"])
    corners = [place(p) for p in opening["outline"]]
    u, z = [dot(along, sub(p[:2], a)) for p in corners], [p[2] for p in corners]
    distance = max(abs(dot(wall["plane"][:3], p) + wall["plane"][3]) for p in corners)
    return [min(u), max(u), min(z), max(z)], distance


def rectangle_iou(a, b):
    w, h = min(a[1], b[1]) - max(a[0], b[0]), min(a[3], b[3]) - max(a[2], b[2])
    if w <= 0 or h <= 0:
        return 0
    area = lambda r: (r[1] - r[0]) * (r[3] - r[2])
    return w * h / (area(a) + area(b) - w * h)


def match_openings(room, truth, place, kinds):
    """Number of true and of measured openings, and the edge errors of those matched."""
    same = lambda a, b: a == b or (a not in HOLES and b not in HOLES)  # a teacher confuses pictures and mirrors
    true = [o for o in truth["openings"] if o["kind"] in kinds]
    found = [o for o in room["openings"] if o["kind"] in kinds]
    walls = {w["id"]: w for w in truth["walls"]}
    pairs = []
    for i, t in enumerate(true):
        own = [t["left"], t["right"], t["sill"], t["top"]]
        for j, f in enumerate(found):
            rectangle, distance = rectangle_on(walls[t["wall"]], f, place)
            iou = rectangle_iou(own, rectangle)
            if same(t["kind"], f["kind"]) and distance < 0.3 and iou >= OPENING_IOU:
                pairs.append((iou, i, j, [abs(x - y) for x, y in zip(own, rectangle)]))
    edges, used = [], set()
    for iou, i, j, errors in sorted(pairs, reverse=True):
        if ("t", i) not in used and ("f", j) not in used:
            used |= {("t", i), ("f", j)}
            edges.append(errors)
    return len(true), len(found), edges


def footprint(box, place):
    (x, y, z), (w, d, h), turn = box["centre"], box["size"], math.radians(box["turn"])
    c, s = math.cos(turn), math.sin(turn)
    corners = [place([x + c * u * w / 2 - s * v * d / 2, y + s * u * w / 2 + c * v * d / 2, z]) for u, v in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return [p[:2] for p in corners], (corners[0][2] - h / 2, corners[0][2] + h / 2)


def area(polygon):
    return abs(sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(polygon, polygon[1:] + polygon[:1]))) / 2


def clipped(polygon, other):
    """The part of a convex polygon in another, both counter-clockwise (Sutherland and Hodgman 1974)."""
    for a, b in zip(other, other[1:] + other[:1]):
        side = lambda p: (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
        out = []
        for p, q in zip(polygon, polygon[1:] + polygon[:1]):
            sp, sq = side(p), side(q)
            if sp >= 0:
                out.append(p)
            if sp * sq < 0:
                out.append(add(p, scaled(sub(q, p), sp / (sp - sq))))
        polygon = out
        if not polygon:
            return []
    return polygon


def box_iou(a, b):
    (pa, za), (pb, zb) = a, b
    height = min(za[1], zb[1]) - max(za[0], zb[0])
    common = clipped(pa, pb)
    if height <= 0 or not common:
        return 0
    both = area(common) * height
    return both / (area(pa) * (za[1] - za[0]) + area(pb) * (zb[1] - zb[0]) - both)


def match_boxes(room, truth, place, with_class):
    """Number of true and of measured boxes, the overlaps of those matched, and their size errors."""
    large = lambda box: max(box["size"]) >= LEAST_BOX
    true, found = [b for b in truth["objects"] if large(b)], [b for b in room["objects"] if large(b)]
    here = lambda p: p
    pairs = [(box_iou(footprint(t, here), footprint(f, place)), i, j) for i, t in enumerate(true) for j, f in enumerate(found)
             if not with_class or t["class"] == f["class"]]
    used, ious, sizes = set(), [], []
    for iou, i, j in sorted(pairs, reverse=True):
        if iou > 0 and ("t", i) not in used and ("f", j) not in used:
            used |= {("t", i), ("f", j)}
            ious.append(iou)
            if iou >= 0.25:
                order = lambda b: sorted(b["size"][:2]) + [b["size"][2]]
                sizes += [abs(x - y) for x, y in zip(order(true[i]), order(found[j]))]
    return len(true), len(found), ious, sizes


def compare(run, truth_scene):
    room = json.loads((Path(run) / "room.json").read_text())
    truth = json.loads((Path(truth_scene) / "truth/room.json").read_text())
    scene = Path(run) / json.loads((Path(run) / "run.json").read_text())["scene"]
    if not (scene / "truth/sparse").exists():
        scene = Path(truth_scene)
    own, exact = camera_centres(Path(run) / "sparse/0"), camera_centres(scene / "truth/sparse")
    names = [n for n in own if n in exact]
    motion, scale = rigid_fit([own[n] for n in names], [exact[n] for n in names])
    place = placed(room, motion, truth)
    positions, lengths = wall_errors(room, truth, place)
    m, t = room["measures"], truth["measures"]
    return {"walls": positions, "lengths": lengths, "height": abs(m["ceiling_height"] - t["ceiling_height"]), "scale": 1 / scale - 1,
            "area": abs(m["floor_area"] / t["floor_area"] - 1), "holes": match_openings(room, truth, place, HOLES),
            "flat": match_openings(room, truth, place, HOLES + ("picture", "mirror")),
            "named": match_boxes(room, truth, place, True), "any": match_boxes(room, truth, place, False)}


def row(name, results):
    """One row of the table over one or more rooms."""
    every = lambda key: [x for r in results for x in r[key]]
    worst = lambda key: max(abs(r[key]) for r in results)
    out = [name, f"{100 * median(every('walls')):.1f} / {100 * max(every('walls')):.1f}", f"{100 * worst('height'):.1f}", f"{100 * worst('area'):.1f}",
           f"{100 * median(every('lengths')):.1f}", f"{100 * worst('scale'):.1f}"]
    for key in ("holes", "flat"):
        true, found = sum(r[key][0] for r in results), sum(r[key][1] for r in results)
        edges = [e for r in results for errors in r[key][2] for e in errors]
        out += [f"{len(edges) // 4}/{true}", f"{len(edges) // 4}/{found}", f"{100 * median(edges):.1f}"]
    for key in ("named", "any"):
        true, found = sum(r[key][0] for r in results), sum(r[key][1] for r in results)
        ious = [i for r in results for i in r[key][2]]
        for least in (0.25, 0.5):
            hits = sum(i >= least for i in ious)
            out.append(f"{hits / max(1, true):.2f} / {hits / max(1, found):.2f}")
    out.append(f"{100 * median([s for r in results for s in r['named'][3]]):.1f}")
    return "| " + " | ".join(out) + " |"


HEADS = ["room", "walls median / worst, cm", "height, cm", "area, %", "wall lengths median, cm", "scale, %", "doors and windows found", "of those claimed right",
         "edges median, cm", "with pictures: found", "claimed right", "edges median, cm", "boxes at 0.25: recall / precision", "at 0.5",
         "any class at 0.25", "at 0.5", "box sizes median, cm"]


def main(arguments):
    if not arguments or len(arguments) % 2:
        sys.exit(__doc__)
    pairs = list(zip(arguments[::2], arguments[1::2]))
    results = [compare(*pair) for pair in pairs]
    print("| " + " | ".join(HEADS) + " |\n|" + "---|" * len(HEADS))
    for (run, _), result in zip(pairs, results):
        print(row(Path(run).name, [result]))
    if len(results) > 1:
        print(row("all", results))


if __name__ == "__main__":
    main(sys.argv[1:])
