#!/usr/bin/env python3
"""Objects of synthetic rooms at IoU 0.5: by votes of the photos' segments against connections alone.

    benchmarks/quality/objects.py OUTPUT [--rooms test] [--seeds 1 2] [--iterations 1000] [--size 320x240]

Each room is made with a simulated panoptic teacher and trained once per draw of the teachers, small, and kept. `aligngs edit RUN
--measure --objects connected|votes` finds the objects again both ways on the same Gaussians. Writes objects.csv and prints a table of
precision, recall and F. ALIGNGS names the program (default build/aligngs)."""
import argparse
import csv
from pathlib import Path

from ladder import ROOMS
from selections import PROGRAM, run

WAYS = ("connected", "votes")
FIELDS = ("truths", "found", "right")


def prepared(room, seed, draw, folder, options):
    """Run of a draw, made and trained once."""
    scene, trained = folder / "scene", folder / "run"
    if not (scene / "truth" / "objects.json").exists():
        run(PROGRAM, "synth", scene, "--room", room, "--seed", seed, "--teacher-seed", draw, "--views", options.views, "--size", options.size,
            "--segments", "teacher", "--overwrite")
    if not (trained / "mesh" / "mesh.ply").exists():
        run(PROGRAM, "run", scene, "-o", trained, "-n", options.iterations, "--overwrite")
    return trained


def measured(trained, way):
    """Counts of the detection, and the mean IoU of the best selections. The run's own scene has the refined cameras, and the truth."""
    result = run(PROGRAM, "edit", trained, "--measure", "--objects", way)
    return {**{f: result["detection"][f] for f in FIELDS}, "mean_iou": result["mean_iou"]}


def scores(rows):
    """Precision, recall and F of all rows together, and their mean IoU."""
    truths, found, right = (sum(r[f] for r in rows) for f in FIELDS)
    ratio = lambda a, b: a / b if b else 0.0
    return ratio(right, found), ratio(right, truths), ratio(2 * right, found + truths), ratio(sum(r["mean_iou"] for r in rows), len(rows))


def table(rows):
    """Lines of Markdown: a line per room, then all."""
    lines = ["| room | draws | objects | precision: connected | votes | recall: connected | votes | F: connected | votes | mean IoU: connected | votes |",
             "|---|---|---|---|---|---|---|---|---|---|---|"]
    for name in [*dict.fromkeys(r["room"] for r in rows), "all"]:
        mine = [r for r in rows if name in (r["room"], "all")]
        of = {way: [r for r in mine if r["way"] == way] for way in WAYS}
        values = {way: scores(of[way]) for way in WAYS}
        cells = " | ".join(f"{values['connected'][k]:.3f} | {values['votes'][k]:.3f}" for k in range(4))
        lines.append(f"| {name} | {len(of['votes'])} | {sum(r['truths'] for r in of['votes'])} | {cells} |")
    return lines


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("output", type=Path)
    parser.add_argument("--rooms", choices=sorted(ROOMS), default="test")
    parser.add_argument("--kinds", nargs="+", help="only rooms of these kinds, e.g. bedroom")
    parser.add_argument("--seeds", nargs="+", type=int, default=[1], help="draws of the teachers")
    parser.add_argument("--iterations", type=int, default=1000)
    parser.add_argument("--views", type=int, default=28)
    parser.add_argument("--size", default="320x240")
    options = parser.parse_args()
    rows = []
    for draw in options.seeds:
        for room, seed in ROOMS[options.rooms]:
            if options.kinds and room not in options.kinds:
                continue
            trained = prepared(room, seed, draw, options.output / f"{room}_{seed}_{draw}", options)
            rows += [{"room": f"{room} {seed}", "draw": draw, "way": way, **measured(trained, way)} for way in WAYS]
            with open(options.output / "objects.csv", "w", newline="") as file:
                writer = csv.DictWriter(file, ["room", "draw", "way", *FIELDS, "mean_iou"])
                writer.writeheader()
                writer.writerows({**r, "mean_iou": f"{r['mean_iou']:.4f}"} for r in rows)
            print("\n".join(table(rows)), flush=True)


if __name__ == "__main__":
    main()
