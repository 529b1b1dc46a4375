#!/usr/bin/env python3
"""The paper's ladder, its controls and yardsticks, on synthetic rooms with simulated teachers.

    benchmarks/quality/ladder.py OUTPUT [--rooms development|test] [--seeds 1 2 3] [--iterations 2000] [--size 320x240] [--rows NAME ...]

Every row is trained on the same rooms with the same teacher draws, so that rows are compared pair by pair (room, seed).
Finished runs in OUTPUT are not repeated: the command can be stopped and started again, with other rows or rooms too; what
results.csv holds stays. It writes

    results.csv    a line per row, room and seed
    settings.json  the program's version and what each row sets
    settings/      every setting of each row, as `aligngs train --config` takes it
    table.md       means, and paired differences with 95 % intervals (percentile bootstrap over the pairs)
    ROOM_SEED.html pictures of all rows side by side (`aligngs compare`)
    acceptance/    what the simulated teachers of each scene measure

The development rooms are those on which defaults are chosen; the test rooms have other furniture, textures and seeds and
are run to report, never to tune. ALIGNGS names the program (default build/aligngs)."""
import argparse
import csv
import json
import math
import os
import random
import resource
import shutil
import subprocess
import sys
from pathlib import Path

PROGRAM = os.environ.get("ALIGNGS", str(Path(__file__).resolve().parents[2] / "build" / "aligngs"))
ROOMS = {
    "development": [("bedroom", 1), ("living", 1), ("kitchen", 1), ("office", 1)],
    "test": [("bedroom", 101), ("living", 102), ("kitchen", 103), ("office", 104)],
}
NO_SEMANTICS = "data.semantics=false"
PHOTOMETRIC = ["loss.pearson=0", "loss.normal_consistency=0", "loss.normal_boundary=0", "data.prior_depth=none"]
NO_GEOMETRY = ["loss.pearson=0", "loss.normal_consistency=0", "loss.normal_boundary=0"]
# The multi-view terms as preset pgsr has them, every fifth step, where they cost a fifth.
MULTI_VIEW = ["loss.multi_view_geometric=0.03", "loss.multi_view_photometric=0.15", "loss.multi_view_every=5"]
# The prior depth as the default preset uses it, acting as early.
PGSR_PRIOR = ["data.prior_depth=auto", "loss.log_depth=0.5", "loss.log_depth_end=0.02", "loss.depth_start=0",
              "loss.depth_align_every=500", "loss.normal_start=500"]
THREE_DGS = PHOTOMETRIC + ["loss.flatten=0", "densify.gradient_abs=0", "mesh.depth=median"]
# Options of `aligngs refine`.
CAMERAS_ONLY = ["--no-stereo", "--no-planes", "--no-exposure"]
NO_LABELS_YET = ["--no-planes"]  # cameras and stereo: what semantics do in training is told apart from what they do before
# Normals at label edges (loss.crease) use labels too, and constant labels have no edges: the controls of the coupling go without.
COUPLING_ALONE = ["loss.crease=0"]
UNCOUPLED = "stereo, uncoupled"
COUPLED = "stereo, coupled, no crease"
PLACEBOS = ["stereo, placebo constant", "stereo, placebo shuffled", "stereo, placebo opacity"]


class Row:
    """One way to train: which cloud and labels the scene has, how `aligngs refine` goes before, and the settings."""

    def __init__(self, name, preset, settings=(), cloud="feedforward", labels="teacher", refine=None, compare_with=(), depth="network"):
        self.name, self.preset, self.settings = name, preset, list(settings)
        self.cloud, self.labels, self.refine, self.depth = cloud, labels, refine, depth
        self.compare_with = [compare_with] if isinstance(compare_with, str) else list(compare_with)

    @property
    def folder(self):
        return "".join(c if c.isalnum() else "_" for c in self.name)


# Also in the paper's rows, which would take many minutes each otherwise: classes that no teacher ranks among its two best share a
# channel (the tests ActiveClasses.* bound what that does to losses and labels), and a step takes the semantic loss of a quarter of the
# pixels (docs/quality.md measures it).
ACTIVE = ["semantic.active_top=2", "semantic.pixel_share=0.25"]



def paper_ladder(where="", refine=None):
    """The paper's Table III, cumulatively, L_sem also as in the release; `where` ends the rows' names, `refine` makes their cameras."""
    steps = [("base (sparse start)", PHOTOMETRIC + [NO_SEMANTICS], []),
             ("+ feed-forward start", PHOTOMETRIC + [NO_SEMANTICS], ["base (sparse start)"]),
             ("+ L_sem, uncoupled", NO_GEOMETRY + ACTIVE + ["semantic.coupling_strength=0"], ["+ feed-forward start"]),
             ("+ L_sem, coupled", NO_GEOMETRY + ACTIVE, ["+ L_sem, uncoupled"]),
             ("+ L_d", ACTIVE + ["loss.normal_consistency=0", "loss.normal_boundary=0"], ["+ L_sem, coupled"]),
             ("+ L_ng + L_nb (paper)", ACTIVE, ["+ L_d", "base (sparse start)"])]
    return [Row(name + where, "paper", settings, cloud="sfm" if k == 0 else "feedforward", refine=refine,
                compare_with=[base + where for base in bases]) for k, (name, settings, bases) in enumerate(steps)]


ROWS = paper_ladder() + paper_ladder(", refined cameras", CAMERAS_ONLY) + [
    Row("release-faithful", "paper", ACTIVE + ["semantic.coupling_strength=0"], compare_with="+ L_ng + L_nb (paper)"),
    Row("3dgs", "paper", THREE_DGS + [NO_SEMANTICS],
        compare_with="base (sparse start)"),
    Row("pgsr", "pgsr", compare_with="+ feed-forward start"),
    Row("pgsr + prior depth", "pgsr", PGSR_PRIOR, compare_with="pgsr"),
    Row("default", "default", compare_with="+ feed-forward start"),
    Row("default, refined cameras", "default", refine=CAMERAS_ONLY, compare_with="default"),
    Row("stereo, no semantics", "default", [NO_SEMANTICS], refine=NO_LABELS_YET),
    Row(UNCOUPLED, "default", COUPLING_ALONE + ["semantic.coupling_strength=0"], refine=NO_LABELS_YET, compare_with="stereo, no semantics"),
    Row(COUPLED, "default", COUPLING_ALONE, refine=NO_LABELS_YET, compare_with=[UNCOUPLED, *PLACEBOS]),
    Row(PLACEBOS[0], "default", COUPLING_ALONE, refine=NO_LABELS_YET, labels="constant", compare_with=UNCOUPLED),
    Row(PLACEBOS[1], "default", COUPLING_ALONE, refine=NO_LABELS_YET, labels="shuffled", compare_with=UNCOUPLED),
    Row(PLACEBOS[2], "default", COUPLING_ALONE + ["semantic.coupling=opacity"], refine=NO_LABELS_YET, compare_with=UNCOUPLED),
    Row("stereo, true labels", "default", COUPLING_ALONE, refine=NO_LABELS_YET, labels="true", compare_with=UNCOUPLED),
    Row("stereo, coupled", "default", refine=NO_LABELS_YET, compare_with=COUPLED),
    Row("default, refined", "default", refine=[],
        compare_with=["stereo, coupled", "default, refined cameras", "pgsr + prior depth, refined cameras", "pgsr, the same scene",
                      "+ L_ng + L_nb (paper)"]),
    Row("default, refined, constant labels", "default", refine=[], labels="constant", compare_with="stereo, coupled"),
    Row("default, refined, photos as exposed", "default", ["data.exposure=false"], refine=[], compare_with="default, refined"),
    Row("default, refined, multi-view terms", "default", MULTI_VIEW, refine=[], compare_with="default, refined"),
    Row("pgsr + prior depth, refined cameras", "pgsr", PGSR_PRIOR, refine=CAMERAS_ONLY, compare_with="pgsr + prior depth"),
    # As from structure from motion, without any network's depth: what labels do before training and in it.
    Row("depth measured, no labels", "default", [NO_SEMANTICS], cloud="sfm", refine=["--no-planes"], depth="measured"),
    Row("depth measured, labels in training alone", "default", cloud="sfm", refine=["--no-planes"], depth="measured",
        compare_with="depth measured, no labels"),
    Row("depth measured, shuffled labels", "default", cloud="sfm", labels="shuffled", refine=[], depth="measured",
        compare_with="depth measured, no labels"),
    Row("depth measured, constant labels", "default", cloud="sfm", labels="constant", refine=[], depth="measured",
        compare_with="depth measured, no labels"),
    Row("depth measured", "default", cloud="sfm", refine=[], depth="measured",
        compare_with=["depth measured, no labels", "depth measured, labels in training alone", "depth measured, shuffled labels",
                      "depth measured, constant labels"]),
    # All that `aligngs refine` finds out is given to pgsr, its dense start included: what is left is training alone.
    Row("pgsr, the same scene", "pgsr", PGSR_PRIOR + ["init.start=depth"], refine=[], compare_with="pgsr + prior depth, refined cameras"),
]
PRIOR, CEILING = "TSDF of the prior depth", "TSDF of the true depth (ceiling)"
REFINED_PRIOR = "TSDF of the refined depth, no training"


class Yardstick:
    """A mesh that no training has touched, with the cameras of the scene that `refine` makes. `prior`: the depth is that of the
    scene with these options of `refine` instead, None for the scene's own."""

    def __init__(self, name, option, refine=None, prior=None):
        self.name, self.option, self.refine, self.prior = name, option, refine, prior


# What counts as the prior is the network's own depth (a smooth factor per photo at most), with the very cameras of the row.
YARDSTICKS = {
    "default": [Yardstick(PRIOR, "--from-prior"), Yardstick(CEILING, "--from-truth")],
    "default, refined": [Yardstick(PRIOR + ", refined cameras", "--from-prior", [], CAMERAS_ONLY),
                         Yardstick(REFINED_PRIOR, "--from-prior", []),
                         Yardstick(CEILING + ", refined cameras", "--from-truth", [])],
}
COLUMNS = [
    ("psnr", "PSNR", 2, "nvs.psnr"), ("fitted", "colour-fitted", 2, "nvs.exposure_fitted.psnr"),
    ("posed", "pose-fitted", 2, "nvs.pose_refined.psnr"),
    ("between", "between", 2, "nvs.interpolating.psnr"),
    ("beyond", "beyond", 2, "nvs.extrapolating.psnr"), ("ssim", "SSIM", 3, "nvs.ssim"),
    ("accuracy", "Acc (m)", 4, "geometry.accuracy"), ("completeness", "Comp (m)", 4, "geometry.completeness"),
    ("precision", "Prec", 3, "geometry.precision"), ("recall", "Recall", 3, "geometry.recall"),
    ("fscore", "F", 3, "geometry.fscore"), ("miou", "mIoU", 3, "semantics.miou"), ("teacher", "teacher's", 3, "semantics.teacher.miou"),
    ("seconds", "processor s", 0, None),
]
PAIR = ("room", "room_seed", "seed")  # what runs are compared by
GEOMETRY = ("accuracy", "completeness", "precision", "recall", "fscore")


def run(*arguments):
    """The program's standard output; ends this script with its message when it fails."""
    done = subprocess.run([PROGRAM, *map(str, arguments), "-q"], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{PROGRAM} {' '.join(map(str, arguments))}\n{done.stderr}")
    return done.stdout


def processor_seconds():
    """Of all programs that this script has waited for: other work on the machine changes it less than the time on the wall."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def value_at(document, path):
    for part in path.split("."):
        document = document.get(part) if isinstance(document, dict) else None
    return float(document) if isinstance(document, (int, float)) else math.nan


def scores(metrics, only=None):
    return {key: value_at(metrics, path) if path and (only is None or key in only) else math.nan for key, _, _, path in COLUMNS}


def make_scene(arguments, room, room_seed, seed, row):
    """The scene of a row; variants differ in the cloud or the labels alone."""
    output = arguments.output
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
    """What structure from motion would leave: cameras (adjusted), points, no network's depth."""
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


def trained(folder, make_scene, row, iterations, seed, settings=()):
    """Scores of the run of a row in `folder`, which is trained first where that is not done. `settings` come beside the row's."""
    spent = folder / "processor_seconds"
    if not (folder / "metrics.json").exists():
        scene = make_scene()
        options = [text for s in [*settings, *row.settings] for text in ("--set", s)]
        interrupted = folder.exists()  # what went before is not known to this process
        before = processor_seconds()
        run("run", scene, "-o", folder, "--preset", row.preset, "-n", iterations, "--seed", seed, "--resume", "--no-refine", *options)
        if not interrupted:
            spent.write_text(str(processor_seconds() - before))
    result = scores(json.loads((folder / "metrics.json").read_text()))
    result["seconds"] = float(spent.read_text()) if spent.exists() else math.nan  # unknown after an interrupted run
    return result


def train(arguments, room, room_seed, seed, row):
    folder = arguments.output / "runs" / f"{room}_{room_seed}_{seed}" / row.folder
    result = trained(folder, lambda: make_scene(arguments, room, room_seed, seed, row), row, arguments.iterations, seed)
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


def mesh_scores(folder, scene, option, preset, seed, settings=()):
    """Scores of a mesh that no training has touched. The run in `folder` that the commands need is one of a single iteration."""
    result = folder / f"yardstick{option}.json"
    if not result.exists():
        if not (folder / "metrics.json").exists():
            options = [text for s in settings for text in ("--set", s)]
            run("run", scene, "-o", folder, "--preset", preset, "-n", 1, "--seed", seed, "--no-refine", "--overwrite", *options)
        mesh = folder / f"yardstick{option}.ply"
        run("mesh", folder, option, "-o", mesh)
        partial = result.with_suffix(".partial")
        partial.write_text(run("eval", folder, "--mesh", mesh, "--no-pose-fit", "--json"))
        partial.rename(result)
        mesh.unlink()
    return scores(json.loads(result.read_text()), GEOMETRY)


def measure_yardstick(arguments, room, room_seed, seed, row, yard):
    scene = yardstick_scene(arguments, room, room_seed, seed, row, yard)
    folder = arguments.output / "runs" / f"{room}_{room_seed}_{seed}" / ("yardstick_" + scene.name)
    return mesh_scores(folder, scene, yard.option, row.preset, seed)


def interval(differences, draws=10000):
    """Mean and 95 % interval of paired differences: percentile bootstrap with a fixed seed."""
    values = [d for d in differences if math.isfinite(d)]
    if not values:
        return math.nan, math.nan, math.nan, 0
    generator = random.Random(1)
    means = sorted(sum(generator.choices(values, k=len(values))) / len(values) for _ in range(draws))
    return sum(values) / len(values), means[int(0.025 * draws)], means[int(0.975 * draws) - 1], len(values)


def number(value, digits):
    return f"{value:.{digits}f}" if math.isfinite(value) else "–"


def mean(values):
    finite = [v for v in values if math.isfinite(v)]
    return sum(finite) / len(finite) if finite else math.nan


def mean_cell(values, digits):
    """The mean; where some pairs lack the number and others have it, of how many."""
    finite = sum(math.isfinite(v) for v in values)
    return number(mean(values), digits) + (f" (of {finite})" if 0 < finite < len(values) else "")


def difference_cell(results, row, base, key, digits):
    pairs = [results[row][k][key] - results[base][k][key] for k in results[row] if k in results[base]]
    middle, low, high, count = interval(pairs)
    if count == 0:
        return "–"
    noise = " (noise)" if count < 3 or low <= 0 <= high else ""
    return f"{middle:+.{digits}f} [{low:+.{digits}f}, {high:+.{digits}f}]{noise}"


def read_csv(file, key_columns):
    """{row: {values of the key columns: scores}}; numbers among the keys are whole. Empty without the file."""
    results = {}
    if file.exists():
        with open(file, newline="") as text:
            for line in csv.DictReader(text):
                key = tuple(int(line[k]) if line[k].isdigit() else line[k] for k in key_columns)
                results.setdefault(line["row"], {})[key] = {k: float(line.get(k) or "nan") for k, *_ in COLUMNS}
    return results


def write_csv(file, key_columns, results):
    with open(file, "w", newline="") as text:
        writer = csv.writer(text)
        writer.writerow(["row", *key_columns] + [key for key, *_ in COLUMNS])
        for name, by_key in results.items():
            for keys, values in by_key.items():
                writer.writerow([name, *keys] + ["" if math.isnan(values[k]) else values[k] for k, *_ in COLUMNS])


def program_version():
    """With the commit of the sources beside this script: defaults change between two releases."""
    commit = subprocess.run(["git", "-C", str(Path(__file__).parent), "describe", "--always", "--dirty"], capture_output=True, text=True)
    return " ".join([run("--version").strip(), commit.stdout.strip()]).strip()


def write_settings(output, arguments):
    """What made the numbers; a table must not mix lengths or rooms, and says when it mixes programs."""
    file = output / "settings.json"
    now = {"programs": [program_version()], "rooms": arguments.rooms, "iterations": arguments.iterations, "size": arguments.size,
           "rows": {r.name: {"preset": r.preset, "set": r.settings, "cloud": r.cloud, "labels": r.labels, "refine": r.refine,
                             "depth": r.depth} for r in ROWS}}
    if file.exists():
        before = json.loads(file.read_text())
        earlier = before.get("programs", [before.get("program", "unknown")])
        now["programs"] = earlier + [p for p in now["programs"] if p not in earlier]
        for key in ("rooms", "iterations", "size"):
            if before.setdefault(key, "320x240") != now[key]:  # the size has not always been noted
                sys.exit(f"{file}: {key} is {before[key]}, and {now[key]} was asked for; give another OUTPUT")
    file.write_text(json.dumps(now, indent=2) + "\n")
    return now["programs"]


def write_tables(output, results, rows, arguments):
    order = [r.name for r in ROWS]
    results = dict(sorted(results.items(), key=lambda item: order.index(item[0]) if item[0] in order else len(order)))
    write_csv(output / "results.csv", PAIR, results)
    lines = [f"{arguments.rooms} rooms, {arguments.iterations} iterations, {arguments.size}, 20 training and 8 test views, **simulated** "
             "teachers of the medium level. Means over the pairs of room and seed, of which there are as many as the second column says. "
             "Processor seconds are those of `run`, without `refine` before it.", "",
             "| row | pairs | " + " | ".join(title for _, title, *_ in COLUMNS) + " |", "|---" * (len(COLUMNS) + 2) + "|"]
    for name, by_pair in results.items():
        lines.append(f"| {name} | {len(by_pair)} | " + " | ".join(mean_cell([v[key] for v in by_pair.values()], digits)
                                                 for key, _, digits, _ in COLUMNS) + " |")
    lines += ["", "Paired differences, mean and 95 % interval over room and seed:", "",
              "| row | against | PSNR (dB) | F | mIoU |", "|---|---|---|---|---|"]
    for row, base in [(r.name, b) for r in ROWS for b in r.compare_with]:
        if base in results and row in results:
            cells = [difference_cell(results, row, base, *column) for column in (("psnr", 2), ("fscore", 3), ("miou", 3))]
            lines.append(f"| {row} | {base} | " + " | ".join(cells) + " |")
    lines += gap_lines(results)
    (output / "table.md").write_text("\n".join(lines) + "\n")


def gap_lines(results):
    """Which share of the way from the prior's own surface to the ceiling a row goes, and its labels against the teacher's."""
    lines = []
    for row in YARDSTICKS:
        gains = [v["miou"] - v["teacher"] for v in results.get(row, {}).values() if math.isfinite(v["miou"] - v["teacher"])]
        if gains:
            middle, low, high, count = interval(gains)
            lines += ["", f"mIoU of `{row}` less that of the teacher on the test photos: {middle:+.3f} [{low:+.3f}, {high:+.3f}], "
                      f"smallest {min(gains):+.3f}, over {count} pairs."]
    for row, (first, *_, last) in YARDSTICKS.items():
        prior, ceiling = results.get(first.name, {}), results.get(last.name, {})
        shares = [(results[row][k]["fscore"] - prior[k]["fscore"]) / (ceiling[k]["fscore"] - prior[k]["fscore"])
                  for k in results.get(row, {}) if k in prior and k in ceiling and ceiling[k]["fscore"] > prior[k]["fscore"]]
        if shares:
            middle, low, high, count = interval(shares)
            lines += ["", f"(F - F_prior) / (F_ceiling - F_prior) of `{row}`: {middle:.2f} [{low:.2f}, {high:.2f}], "
                      f"smallest {min(shares):.2f}, over {count} pairs."]
    placebos = [results[p] for p in PLACEBOS if p in results]
    if placebos and COUPLED in results:
        for key, title, digits in (("fscore", "F", 3), ("psnr", "PSNR (dB)", 2)):
            over = [results[COUPLED][k][key] - max(p[k][key] for p in placebos)
                    for k in results[COUPLED] if all(k in p for p in placebos)]
            if over:
                middle, low, high, count = interval(over)
                lines += ["", f"{title} of `{COUPLED}` over the best of {len(placebos)} placebos of each pair: {middle:+.{digits}f} "
                          f"[{low:+.{digits}f}, {high:+.{digits}f}] over {count} pairs."]
    return lines


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("output", type=Path)
    parser.add_argument("--rooms", choices=sorted(ROOMS), default="development")
    parser.add_argument("--kinds", nargs="+", default=None, help="only rooms of these kinds, e.g. bedroom")
    parser.add_argument("--seeds", nargs="+", type=int, default=[1, 2, 3])
    parser.add_argument("--iterations", type=int, default=2000)
    parser.add_argument("--size", default="320x240", help="of the photos, WxH")
    parser.add_argument("--rows", nargs="+", default=None, help="only these rows (names as in the table)")
    parser.add_argument("--keep-scenes", action="store_true", help="keep the scenes (some 100 MB each) after their last row")
    arguments = parser.parse_args()
    rows = [r for r in ROWS if arguments.rows is None or r.name in arguments.rows]
    if not rows:
        parser.error("no such row; there are: " + ", ".join(r.name for r in ROWS))
    output = arguments.output
    output.mkdir(parents=True, exist_ok=True)
    programs = write_settings(output, arguments)
    if len(programs) > 1:
        print(f"{output}: rows of an earlier call stay, made by another program: {', '.join(programs[:-1])}", file=sys.stderr)
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
                    write_tables(output, results, rows, arguments)
            for row in rows:
                for yard in YARDSTICKS.get(row.name, []):
                    if key not in results.setdefault(yard.name, {}):
                        results[yard.name][key] = measure_yardstick(arguments, room, room_seed, seed, row, yard)
            folders = [f for f in (output / "runs" / f"{room}_{room_seed}_{seed}" / r.folder for r in ROWS) if f.exists()]
            for folder in folders:  # the largest part of a run, and done with
                shutil.rmtree(folder / "checkpoints", ignore_errors=True)
            if len(folders) > 1:
                run("compare", *folders, "--html", output / f"{room}_{room_seed}_{seed}.html")
            if not arguments.keep_scenes:
                for scene in (output / "scenes").glob(f"{room}_{room_seed}_{seed}_*"):
                    shutil.rmtree(scene)
            write_tables(output, results, rows, arguments)
    print((output / "table.md").read_text())


if __name__ == "__main__":
    main()
