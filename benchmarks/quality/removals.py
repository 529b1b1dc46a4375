#!/usr/bin/env python3
"""Objects taken away from synthetic rooms, against the truth of the rooms without them.

    benchmarks/quality/removals.py OUTPUT [--rooms bedroom:11 living:12] [--iterations 2000] [--old PROGRAM] [--objects NAME ...]

Each room is made with `aligngs synth --without` for every object, and trained once. Each removal is tried without filling, with
the filling of --old (another build of the program), and with the filling of this build. Of every result: PSNR and SSIM over the
test views in the widened mask of the object, and F at 5 cm in its box. Trained rooms, scores and a picture of each removal are kept,
edited rooms are not. Writes removals.csv, removals.md and, with ffmpeg, sheet.png: before, each variant, and the truth of the test
view that shows most of the object. ALIGNGS names the program (default build/aligngs)."""
import argparse
import csv
import functools
import json
import math
import os
import shutil
import subprocess
from pathlib import Path

PROGRAM = os.environ.get("ALIGNGS", "build/aligngs")
# What a removal of each kind of room takes; the room's own names (`aligngs synth` lists them for a wrong one).
OBJECTS = {
    "bedroom": ["bed#1", "chest of drawers#1", "painting#1", "rug#1", "lamp#1", "wardrobe#1"],
    "living": ["sofa#1", "coffee table#1", "painting#1", "rug#1", "lamp#1", "armchair#1"],
    "kitchen": ["table#1", "chair#1", "refrigerator#1", "painting#1", "vase#1", "rug#1"],
    "office": ["desk#1", "swivel chair#1", "bookcase#1", "bulletin board#1", "lamp#1", "rug#1"],
}
VARIANTS = ("no fill", "old fill", "new fill")
LARGEST_OFFSET = 0.6  # metres between the middles of a true object and of the run's object of that class


def run(program, *arguments, quiet=True):
    """Standard output of the program as JSON."""
    command = [program, *map(str, arguments), "-q", "--json"] if quiet else [program, *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(command)}\n{done.stderr}")
    return json.loads(done.stdout) if done.stdout.strip() else {}


def folder_of(name):
    return name.replace(" ", "_")


def prepared(room, seed, folder, options):
    """Makes and trains a room once, and returns its run folder."""
    scene, trained = folder / "scene", folder / "run"
    if not (trained / "mesh" / "mesh.ply").exists():
        without = [word for name in options.objects or OBJECTS[room] for word in ("--without", name)]
        if not (scene / "truth" / "mesh.ply").exists():
            run(PROGRAM, "synth", scene, "--room", room, "--seed", seed, "--views", options.views, "--size", options.size, *without)
        settings = [word for setting in options.set for word in ("--set", setting)]
        run(PROGRAM, "run", scene, "-o", trained, "-n", options.iterations, *settings, "--overwrite")
    return scene, trained


def run_object(program, trained, truth):
    """The object of the run, by a program's own names, that is nearest to a true object; None where none of the class is near."""
    true = json.loads((truth / "removal.json").read_text())["objects"][0]
    middle = [(a + b) / 2 for a, b in zip(true["low"], true["high"])]
    best = None
    for found in run(program, "edit", trained, "--list")["objects"]:
        if found["object"].split("#")[0] != true["class"]:
            continue
        distance = math.dist(found["centre"], middle)
        if distance < LARGEST_OFFSET and (best is None or distance < best[0]):
            best = (distance, found["object"])
    return best and best[1]


def pixels_of(mask):
    """How many pixels of a mask are set."""
    shown = subprocess.run(["ffmpeg", "-v", "error", "-i", mask, "-f", "rawvideo", "-pix_fmt", "gray", "-"], capture_output=True)
    return sum(value > 0 for value in shown.stdout)


@functools.cache
def best_view(truth):
    """File name of the test view that shows most of the object."""
    return max(sorted((truth / "mask").iterdir()), key=pixels_of).name


def measured(trained, truth, variant, folder, options):
    """The scores of one removal; None where the program finds no such object."""
    out = folder / folder_of(f"{truth.name} {variant}")
    kept = out.with_suffix(".json")
    if kept.exists():
        return json.loads(kept.read_text())
    program = options.old if variant == "old fill" else PROGRAM
    target = run_object(program, trained, truth)
    if target is None:
        return None
    if not (out / "run.json").exists():
        fill = [] if variant == "no fill" else ["--fill"]
        run(program, "edit", trained, "--select", target, "--delete", *fill, "-o", out)
    scores = run(PROGRAM, "edit", out, "--truth", truth)
    if shutil.which("ffmpeg"):
        shutil.copy(out / "renders" / "test" / "rgb" / best_view(truth), out.with_suffix(".png"))
    shutil.rmtree(out)
    kept.write_text(json.dumps(scores))
    return scores


def write_sheet(rows, variants, output):
    """A line of pictures per removal, in the order of the table."""
    lines = []
    for row in rows:
        folder = output / row["room"].replace(":", "_")
        truth = folder / "scene" / "truth" / "without" / row["object"]
        view = best_view(truth)
        variant_pictures = [folder / (folder_of(f"{row['object']} {v}") + ".png") for v in variants]
        lines.append([folder / "run" / "renders" / "test" / "rgb" / view, *variant_pictures, truth / "rgb" / view])
    files = [file for line in lines for file in line]
    across = len(lines[0])
    parts = [f"[{i}:v]scale=240:180,format=rgb24[p{i}]" for i in range(len(files))]
    parts += ["".join(f"[p{k * across + i}]" for i in range(across)) + f"hstack={across}[l{k}]" for k in range(len(lines))]
    parts.append("".join(f"[l{k}]" for k in range(len(lines))) + (f"vstack={len(lines)}" if len(lines) > 1 else "null") + "[sheet]")
    inputs = [word for file in files for word in ("-i", str(file))]
    subprocess.run(["ffmpeg", "-v", "error", "-y", *inputs, "-filter_complex", ";".join(parts), "-map", "[sheet]", "-frames:v", "1",
                    str(output / "sheet.png")], check=True)


def table(rows, variants):
    lines = ["| room | object | " + " | ".join(f"{v}: PSNR, SSIM, F" for v in variants) + " |", "|---|---|" + "---|" * len(variants)]
    for row in rows:
        cells = [f"{s['psnr']:.2f}, {s['ssim']:.3f}, {s['fscore']:.3f}" for s in (row["scores"][v] for v in variants)]
        lines.append(f"| {row['room']} | {row['object']} | " + " | ".join(cells) + " |")
    means = [[sum(r["scores"][v][k] for r in rows) / len(rows) for k in ("psnr", "ssim", "fscore")] for v in variants]
    lines.append("| mean | | " + " | ".join(f"{p:.2f}, {s:.3f}, {f:.3f}" for p, s, f in means) + " |")
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("output", type=Path)
    parser.add_argument("--rooms", nargs="+", default=["bedroom:11"], help="KIND:SEED")
    parser.add_argument("--objects", nargs="+", help="instead of those of each kind of room")
    parser.add_argument("--iterations", type=int, default=2000)
    parser.add_argument("--views", type=int, default=28)
    parser.add_argument("--size", default="320x240")
    parser.add_argument("--old", help="program whose filling is compared")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="setting of the training, for instance "
                        "checkpoint.keep_finished=true, which programs before 0.2 need")
    options = parser.parse_args()
    variants = [v for v in VARIANTS if v != "old fill" or options.old]
    rows = []
    for text in options.rooms:
        room, seed = text.split(":")
        folder = options.output / f"{room}_{seed}"
        scene, trained = prepared(room, seed, folder, options)
        for truth in sorted((scene / "truth" / "without").iterdir()):
            try:
                scores = {v: measured(trained, truth, v, folder, options) for v in variants}
            except RuntimeError as error:
                print(f"{text}: {truth.name} is left out: {error}")
                continue
            missing = [v for v in variants if scores[v] is None]
            if missing:
                print(f"{text}: the run has no {truth.name} for {', '.join(missing)}")
                continue
            rows.append({"room": text, "object": truth.name, "scores": scores})
    with open(options.output / "removals.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["room", "object", "variant", "views", "psnr", "ssim", "precision", "recall", "fscore"])
        for row in rows:
            for variant in variants:
                s = row["scores"][variant]
                writer.writerow([row["room"], row["object"], variant] + [s[k] for k in ("views", "psnr", "ssim", "precision", "recall", "fscore")])
    if rows:
        (options.output / "removals.md").write_text(table(rows, variants))
        print(table(rows, variants))
        if shutil.which("ffmpeg"):
            write_sheet(rows, variants, options.output)


if __name__ == "__main__":
    main()
