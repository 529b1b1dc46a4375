#!/usr/bin/env python3
"""How well each object of synthetic rooms can be selected: IoU of the reconstructed surface, per object.

    benchmarks/quality/selections.py OUTPUT [--rooms bedroom:101 living:102 kitchen:103 office:104] [--before PROGRAM]

Each room is made and trained once, small, and kept. `aligngs edit RUN --measure` scores every true object with the selection that fits
it best. --before is another build of the program, whose selections are compared. Writes selections.csv and prints a table of means.
ALIGNGS names the program (default build/aligngs)."""
import argparse
import csv
import json
import os
import subprocess
from pathlib import Path

PROGRAM = os.environ.get("ALIGNGS", "build/aligngs")
WORSE = 0.02  # of IoU: less is noise of the surface samples


def run(program, *arguments):
    """Standard output of the program as JSON."""
    command = [program, *map(str, arguments), "-q", "--json"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(command)}\n{done.stderr}")
    return json.loads(done.stdout) if done.stdout.strip() else {}


def prepared(room, seed, folder, options):
    """Scene and run of a room, made and trained once."""
    scene, trained = folder / "scene", folder / "run"
    if not (scene / "truth" / "objects.json").exists():
        run(PROGRAM, "synth", scene, "--room", room, "--seed", seed, "--views", options.views, "--size", options.size, "--overwrite")
    if not (trained / "mesh" / "mesh.ply").exists():
        run(PROGRAM, "run", scene, "-o", trained, "-n", options.iterations, "--overwrite")
    return scene, trained


def scores(program, scene, trained):
    """IoU by object."""
    return {o["object"]: o["iou"] for o in run(program, "edit", trained, "--scene", scene, "--measure")["objects"]}


def summary(room, rows):
    """A row of the table: means, and how many objects changed by more than noise."""
    before, after = ([r[k] for r in rows] for k in ("before", "after"))
    mean = [sum(v) / len(v) for v in (before, after)]
    gains = [a - b for a, b in zip(after, before)]
    better, worse = sum(g > WORSE for g in gains), sum(g < -WORSE for g in gains)
    return f"| {room} | {len(rows)} | {mean[0]:.3f} | {mean[1]:.3f} | {mean[1] - mean[0]:+.3f} | {better} | {worse} | {min(gains):+.3f} |"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("output", type=Path)
    parser.add_argument("--rooms", nargs="+", default=["bedroom:101", "living:102", "kitchen:103", "office:104"], help="KIND:SEED")
    parser.add_argument("--iterations", type=int, default=1000)
    parser.add_argument("--views", type=int, default=28)
    parser.add_argument("--size", default="240x180")
    parser.add_argument("--before", help="program whose selections are compared; the same one without it")
    options = parser.parse_args()
    rows = []
    for text in options.rooms:
        room, seed = text.split(":")
        scene, trained = prepared(room, seed, options.output / f"{room}_{seed}", options)
        after = scores(PROGRAM, scene, trained)
        before = scores(options.before, scene, trained) if options.before else after
        rows += [{"room": text, "object": name, "before": before[name], "after": after[name]} for name in after]
    with open(options.output / "selections.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, ["room", "object", "before", "after"])
        writer.writeheader()
        writer.writerows({**r, "before": f"{r['before']:.3f}", "after": f"{r['after']:.3f}"} for r in rows)
    print("| room | objects | before | after | gain | better | worse | worst |\n|---|---|---|---|---|---|---|---|")
    for text in options.rooms:
        print(summary(text, [r for r in rows if r["room"] == text]))
    print(summary("all", rows))


if __name__ == "__main__":
    main()
