#!/usr/bin/env python3
"""Rooms from weaker simulated cameras and depth, beside those of the medium level.

    benchmarks/quality/teacher_levels.py OUTPUT [--rooms development|test] [--seeds 1 2 3] [--iterations 1000] [--size 320x240]

Each room is refined, trained, meshed and evaluated by `aligngs run`, once for each level of `aligngs synth`. The room, its
photos, labels and test views stay the same, so that levels are compared pair by pair. Finished runs in OUTPUT are not
repeated. The script writes OUTPUT/levels.csv and OUTPUT/table.md. ALIGNGS names the program (default build/aligngs)."""
import argparse
import csv
import json
import sys
from pathlib import Path

from ladder import ROOMS, run, value_at

LEVELS = ("medium", "base", "small")
FIGURES = (  # name, path in metrics.json, decimals
    ("PSNR", "nvs.psnr", 2),
    ("F at 5 cm", "geometry.fscore", 3),
    ("mIoU", "semantics.miou", 3),
)


def measure(output, room, room_seed, seed, level, arguments):
    """Figures of one room at one level, and of its simulated cameras before the refinement."""
    scene = output / f"{room}_{room_seed}_{seed}_{level}"
    folder = output / f"{scene.name}.run"
    printed = output / f"{scene.name}.json"
    if not printed.exists():
        text = run("synth", scene, "--room", room, "--room-seed", room_seed, "--teacher-seed", seed, "--level", level, "--size",
                   arguments.size, "--overwrite", "--json")
        printed.write_text(text)
    if not (folder / "metrics.json").exists():
        run("run", scene, "-o", folder, "--overwrite", "-n", arguments.iterations)
    metrics = json.loads((folder / "metrics.json").read_text())
    figures = {f["name"]: f["value"] for f in json.loads(printed.read_text())["acceptance"]["figures"]}
    row = {"room": room, "room_seed": room_seed, "seed": seed, "level": level}
    row.update({name: value_at(metrics, path) for name, path, _ in FIGURES})
    row["pair error"] = figures["pair pose error mean, unclipped"]
    row["AUC"] = figures["pair pose AUC at 30 degrees"]
    return row


def mean(values):
    return sum(values) / len(values)


def table(rows):
    """Means over the rooms of each level, and the differences to medium: mean, and the worst pair."""
    lines = ["| level | pair error of the cameras | AUC at 30 degrees | " + " | ".join(f"{n} | lost, mean (most)" for n, _, _ in FIGURES) + " |",
             "|---|---|---|" + "---|---|" * len(FIGURES)]
    pair = {(r["room"], r["room_seed"], r["seed"], r["level"]): r for r in rows}
    for level in LEVELS:
        own = [r for r in rows if r["level"] == level]
        if not own:
            continue
        cells = [level, f"{mean([r['pair error'] for r in own]):.2f} deg", f"{mean([r['AUC'] for r in own]):.3f}"]
        for name, _, decimals in FIGURES:
            lost = [pair[(r["room"], r["room_seed"], r["seed"], "medium")][name] - r[name] for r in own
                    if (r["room"], r["room_seed"], r["seed"], "medium") in pair]
            cells.append(f"{mean([r[name] for r in own]):.{decimals}f}")
            cells.append("–" if level == "medium" or not lost else f"{mean(lost):.{decimals}f} ({max(lost):.{decimals}f})")
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("output", type=Path)
    parser.add_argument("--rooms", choices=ROOMS, default="development")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1])
    parser.add_argument("--levels", choices=LEVELS, nargs="+", default=list(LEVELS))
    parser.add_argument("--iterations", type=int, default=1000)
    parser.add_argument("--size", default="320x240")
    arguments = parser.parse_args()
    arguments.output.mkdir(parents=True, exist_ok=True)
    rows = []
    for seed in arguments.seeds:
        for room, room_seed in ROOMS[arguments.rooms]:
            for level in arguments.levels:
                rows.append(measure(arguments.output, room, room_seed, seed, level, arguments))
                print(rows[-1], file=sys.stderr, flush=True)
                with open(arguments.output / "levels.csv", "w", newline="", encoding="utf-8") as file:
                    writer = csv.DictWriter(file, fieldnames=list(rows[0]))
                    writer.writeheader()
                    writer.writerows(rows)
                (arguments.output / "table.md").write_text(table(rows), encoding="utf-8")
    print(table(rows))


if __name__ == "__main__":
    main()
