#!/usr/bin/env python3
"""The paper's ladder, its controls and yardsticks, on synthetic rooms with simulated teachers.

    benchmarks/quality/ladder.py OUTPUT [--rooms development|test] [--seeds 1 2 3] [--iterations 2000] [--size 320x240] [--rows NAME ...]

Every row is trained on the same rooms with the same teacher draws, so that rows are compared pair by pair (room, seed).
Finished runs in OUTPUT are not repeated: the command can be stopped and started again, with other rows or rooms too. The
content of results.csv stays. It writes

    results.csv    a line per row, room and seed
    settings.json  the program's version and what each row sets
    settings/      every setting of each row, as `aligngs train --config` takes it
    table.md       means, and paired differences with 95 % intervals (percentile bootstrap over rooms, and seeds within each)
    ROOM_SEED.html pictures of all rows side by side (`aligngs compare`)
    acceptance/    what the simulated teachers of each scene measure

The development rooms are those on which defaults are chosen; the test rooms have other furniture, textures and seeds and
are run to report, never to tune. ALIGNGS names the program (default build/aligngs)."""
import argparse
import json
import math
import os
import resource
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

from ladder_rows import CAMERAS_ONLY, COLUMNS, FUSED_AS_DEFAULT, GEOMETRY, PAIR, ROWS, YARDSTICKS, Row
from ladder_tables import read_csv, write_tables

PROGRAM = os.environ.get("ALIGNGS", str(Path(__file__).resolve().parents[2] / "build" / "aligngs"))
ROOMS = {
    "development": [("bedroom", 1), ("living", 1), ("kitchen", 1), ("office", 1)],
    "test": [("bedroom", 101), ("living", 102), ("kitchen", 103), ("office", 104)],
}


def set_options(settings):
    return [text for s in settings for text in ("--set", s)]


def run(*arguments):
    """The program's standard output; ends this script with its message when it fails."""
    done = subprocess.run([PROGRAM, *map(str, arguments), "-q"], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{PROGRAM} {' '.join(map(str, arguments))}\n{done.stderr}")
    return done.stdout


def processor_seconds():
    """Time of all programs that this script has waited for: other work on the machine changes it less than wall time."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def value_at(document, path):
    """The number at a path of keys; of a list, a key takes the first item whose protocol begins so."""
    for part in path.split("."):
        if isinstance(document, list):
            document = next((item for item in document if item["protocol"].startswith(part)), None)
        else:
            document = document.get(part) if isinstance(document, dict) else None
    return float(document) if isinstance(document, (int, float)) else math.nan


def scores(metrics, only=None):
    return {key: value_at(metrics, path) if path and (only is None or key in only) else math.nan for key, _, _, path in COLUMNS}


def make_scene(arguments, room, room_seed, seed, row):
    """The scene of a row; variants differ in the cloud or the labels alone."""
    output = arguments.output
    seed = seed if arguments.teacher_seed is None else arguments.teacher_seed
    folder = output / "scenes" / f"{room}_{room_seed}_{seed}_{row.cloud}_{row.labels}"
    if not (folder / "scene.json").exists():
        text = run("synth", folder, "--room", room, "--room-seed", room_seed, "--teacher-seed", seed, "--cloud", row.cloud,
                   "--labels", row.labels, "--size", arguments.size, "--overwrite")
        if row.cloud == "feedforward" and row.labels == "teacher":
            (output / "acceptance").mkdir(exist_ok=True)
            (output / "acceptance" / f"{room}_{room_seed}_{seed}.txt").write_text(text.replace(str(folder), folder.name))
    if row.depth == "measured":
        folder = without_depth(refined_scene(folder, CAMERAS_ONLY))
    return folder if row.refine is None else refined_scene(folder, row.refine)


def without_depth(scene):
    """The result of structure from motion: cameras (adjusted), points, no network's depth."""
    bare = scene.with_name(scene.name + "_bare")
    if not bare.exists():
        partial = bare.with_name(bare.name + ".partial")
        shutil.rmtree(partial, ignore_errors=True)
        shutil.copytree(scene, partial, ignore=shutil.ignore_patterns("pred_depths", "pred_confidence"))
        priors = json.loads((partial / "priors.json").read_text())
        del priors["depth"]
        (partial / "priors.json").write_text(json.dumps(priors))
        partial.rename(bare)
    return bare


def refined_scene(folder, options):
    better = folder.with_name("_".join([folder.name, "refined"] + [o.strip("-") for o in options]))
    if not better.exists():
        run("refine", folder, "-o", better, *options)
    return better


def trained(folder, make_scene, row, iterations, seed, settings=(), device="auto"):
    """Scores of the run of a row in `folder`, which is trained first where that is not done. `settings` come beside the row's."""
    spent = folder / "processor_seconds"
    if not (folder / "metrics.json").exists():
        scene = make_scene()
        # A checkpoint at the end alone: rows are short, and half a gigabyte every 500 steps takes some seconds.
        settings = [f"checkpoint.every={iterations}", *settings, *row.settings]
        options = set_options(settings)
        interrupted = folder.exists()  # what went before is not known to this process
        before = processor_seconds()
        run("run", scene, "-o", folder, "--preset", row.preset, "-n", iterations, "--seed", seed, "--resume", "--no-refine", "--device", device,
            *options)
        if not interrupted:
            spent.write_text(str(processor_seconds() - before))
    result = scores(json.loads((folder / "metrics.json").read_text()))
    result["seconds"] = float(spent.read_text()) if spent.exists() else math.nan  # unknown after an interrupted run
    return result


def train(arguments, room, room_seed, seed, row):
    folder = arguments.output / "runs" / f"{room}_{room_seed}_{seed}" / row.folder
    result = trained(folder, lambda: make_scene(arguments, room, room_seed, seed, row), row, arguments.iterations, seed,
                     device=arguments.device)
    kept = arguments.output / "settings" / f"{row.folder}.toml"
    if not kept.exists() and (folder / "config.toml").exists():
        kept.parent.mkdir(exist_ok=True)
        shutil.copy(folder / "config.toml", kept)
    return result


def yardstick_scene(arguments, room, room_seed, seed, row, yard):
    base = make_scene(arguments, room, room_seed, seed, Row("", row.preset))
    if yard.refine is None:
        return base
    scene = refined_scene(base, yard.refine)
    if yard.prior is None:
        return scene
    mixed = scene.with_name(scene.name + "_prior")
    if not mixed.exists():
        partial = mixed.with_name(mixed.name + ".partial")
        shutil.rmtree(partial, ignore_errors=True)
        shutil.copytree(scene, partial)
        shutil.rmtree(partial / "pred_depths")
        shutil.copytree(refined_scene(base, yard.prior) / "pred_depths", partial / "pred_depths")
        partial.rename(mixed)
    return mixed


def measure_mesh(folder, result, *options):
    """Writes to `result` what `aligngs eval` says of the mesh that `aligngs mesh` makes of a run with these options."""
    mesh = result.with_suffix(".ply")
    run("mesh", folder, "-o", mesh, *options)
    partial = result.with_suffix(".partial")
    partial.write_text(run("eval", folder, "--mesh", mesh, "--no-views", "--json"))
    partial.rename(result)
    mesh.unlink()


def mesh_scores(folder, scene, option, preset, seed, settings=()):
    """Scores of a mesh that no training has touched. The run in `folder` that the commands need is one of a single iteration."""
    result = folder / f"yardstick{option}.json"
    if not result.exists():
        if not (folder / "metrics.json").exists():
            options = set_options(settings)
            run("run", scene, "-o", folder, "--preset", preset, "-n", 1, "--seed", seed, "--no-refine", "--overwrite", *options)
        measure_mesh(folder, result, option)
    return scores(json.loads(result.read_text()), GEOMETRY)


def measure_yardstick(arguments, room, room_seed, seed, row, yard):
    scene = yardstick_scene(arguments, room, room_seed, seed, row, yard)
    folder = arguments.output / "runs" / f"{room}_{room_seed}_{seed}" / ("yardstick_" + scene.name)
    return mesh_scores(folder, scene, yard.option, row.preset, seed)


def fusion_settings(preset):
    """The settings of `aligngs mesh` in a preset, as --set takes them."""
    table = tomllib.loads(run("train", "--print-config", "--preset", preset))["mesh"]
    return [f"mesh.{key}={str(value).lower() if isinstance(value, bool) else value}" for key, value in table.items()]


def fused_as_default(folder):
    """Scores of a trained run's mesh when it is fused with the settings of preset default. Needs the run's checkpoints."""
    result = folder / "fused_as_default.json"
    if not result.exists():
        measure_mesh(folder, result, *set_options(fusion_settings("default")))
    return scores(json.loads(result.read_text()), GEOMETRY)


def program_version(device="auto"):
    """With the commit of the sources beside this script, for defaults change between two releases, and the device where one was named."""
    commit = subprocess.run(["git", "-C", str(Path(__file__).parent), "describe", "--always", "--dirty"], capture_output=True, text=True)
    named = [] if device == "auto" else [f"on {device}"]
    return " ".join([run("--version").strip(), commit.stdout.strip(), *named]).strip()


def write_page(folders, page):
    """Pictures of the runs that are done, side by side; one alone has nothing beside it."""
    done = [f for f in folders if (f / "metrics.json").exists()]
    if len(done) > 1:
        run("compare", *done, "--html", page)


def write_settings(output, conditions, rows, device="auto"):
    """The origin of the numbers; a table must not mix conditions (as lengths or rooms), and names several programs."""
    file = output / "settings.json"
    now = {"programs": [program_version(device)], **conditions, "rows": rows}
    if file.exists():
        before = json.loads(file.read_text())
        earlier = before.get("programs", [before.get("program", "unknown")])
        now["programs"] = earlier + [p for p in now["programs"] if p not in earlier]
        for key, value in conditions.items():
            if before.get(key, value) != value:
                sys.exit(f"{file}: {key} is {before[key]}, and {value} was asked for; give another OUTPUT")
    file.write_text(json.dumps(now, indent=2) + "\n")
    if len(now["programs"]) > 1:
        print(f"{output}: rows of an earlier call stay, made by another program: {', '.join(now['programs'][:-1])}", file=sys.stderr)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("output", type=Path)
    parser.add_argument("--rooms", choices=sorted(ROOMS), default="development")
    parser.add_argument("--kinds", nargs="+", default=None, help="only rooms of these kinds, e.g. bedroom")
    parser.add_argument("--seeds", nargs="+", type=int, default=[1, 2, 3])
    parser.add_argument("--teacher-seed", type=int, help="one draw of the teachers for all seeds: what differs then is training alone")
    parser.add_argument("--iterations", type=int, default=2000)
    parser.add_argument("--size", default="320x240", help="of the photos, WxH")
    parser.add_argument("--device", default="auto", help="auto, cpu or cuda:N: where the rows are trained and their meshes fused")
    parser.add_argument("--rows", nargs="+", default=None, help="only these rows (names as in the table)")
    parser.add_argument("--keep-scenes", action="store_true", help="keep the scenes (some 100 MB each) after their last row")
    arguments = parser.parse_args()
    rows = [r for r in ROWS if arguments.rows is None or r.name in arguments.rows]
    if not rows:
        parser.error("no such row; there are: " + ", ".join(r.name for r in ROWS))
    output = arguments.output
    output.mkdir(parents=True, exist_ok=True)
    write_settings(output, {"rooms": arguments.rooms, "iterations": arguments.iterations, "size": arguments.size,
                            "teacher_seed": arguments.teacher_seed},
                   {r.name: {"preset": r.preset, "set": r.settings, "cloud": r.cloud, "labels": r.labels, "refine": r.refine, "depth": r.depth}
                    for r in ROWS}, arguments.device)
    results = read_csv(output / "results.csv", PAIR)
    for room, room_seed in ROOMS[arguments.rooms]:
        if arguments.kinds and room not in arguments.kinds:
            continue
        for seed in arguments.seeds:
            key = (room, room_seed, seed)
            for row in rows:
                if key not in results.setdefault(row.name, {}):
                    print(f"{room} {room_seed}, seed {seed}: {row.name}", flush=True)
                    results[row.name][key] = train(arguments, room, room_seed, seed, row)
                    write_tables(arguments, results)
            for row in rows:
                for yard in YARDSTICKS.get(row.name, []):
                    if key not in results.setdefault(yard.name, {}):
                        results[yard.name][key] = measure_yardstick(arguments, room, room_seed, seed, row, yard)
                again = FUSED_AS_DEFAULT.get(row.name)
                if again and key not in results.setdefault(again, {}):
                    results[again][key] = fused_as_default(output / "runs" / f"{room}_{room_seed}_{seed}" / row.folder)
            folders = [output / "runs" / f"{room}_{room_seed}_{seed}" / r.folder for r in ROWS]
            write_page(folders, output / f"{room}_{room_seed}_{seed}.html")
            if not arguments.keep_scenes:
                for scene in (output / "scenes").glob(f"{room}_{room_seed}_{seed}_*"):
                    shutil.rmtree(scene)
            write_tables(arguments, results)
    print((output / "table.md").read_text())


if __name__ == "__main__":
    main()
