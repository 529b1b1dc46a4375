#!/usr/bin/env python3
"""A real capture with a reference surface, by the source of its start: photos alone, a simulated network, the depth sensor.

    benchmarks/quality/capture.py CAPTURE OUTPUT --sfm MODEL [--seeds 1 2 3] [--iterations 2000] [--scale 0.5] [--rows NAME ...]

CAPTURE is a folder that `aligngs import` reads, MODEL a COLMAP model of the training photos for `rgb`. Rows:

    rgb         points of structure from motion, true cameras, depth only as `aligngs refine` measures it in the photos: the headline
    simulated   cameras, depth and points of `aligngs data simulate`, another draw per seed; called simulated wherever shown
    rgbd        the sensor's depth, from which the reference was fused: shows only that nothing is lost

Rows that need labels stay empty: a capture without labels has none. Finished runs are not repeated. Writes results.csv,
settings.json, table.md and a page of pictures per seed (pictures of a capture are its owner's: keep the pages). ALIGNGS names the
program (default build/aligngs)."""
import argparse
import shutil
from pathlib import Path

import ladder
import ladder_rows
import ladder_tables

REFINED = []  # options of `aligngs refine`


class Row(ladder_rows.Row):
    """A row of a source. The source's name precedes the row's and those that it is compared with."""

    def __init__(self, source, name, preset, settings=(), refine=None, compare_with=()):
        super().__init__(f"{source}: {name}", preset, settings, refine=refine, compare_with=[f"{source}: {c}" for c in compare_with])
        self.source = source


DROPOUT = ladder_rows.WITH["opacity dropout of 0.2"]
# Chosen on synthetic rooms, whose surfaces have no gloss: what of it holds on real photos.
CHANGES = {
    "without opacity dropout": ladder_rows.WITHOUT["opacity dropout"],
    "without prior normals": ladder_rows.WITHOUT["prior normals"],
    "with opacity dropout of 0.2": DROPOUT,
    "with opacity dropout of 0.2 that ends early": DROPOUT + ladder_rows.WITH["shorter opacity dropout"],
    "with opacity dropout of 0.2, without minimum splat size": DROPOUT + ladder_rows.WITHOUT["minimum splat size"],
}
ROWS = [
    Row("rgb", "3dgs", "paper", ladder_rows.THREE_DGS),
    Row("rgb", "pgsr", "pgsr", compare_with=["3dgs"]),
    Row("rgb", "default", "default", refine=REFINED, compare_with=["3dgs", "pgsr", "default, from the points", "pgsr, the same scene"]),
    Row("rgb", "pgsr, the same scene", "pgsr", ladder_rows.PGSR_PRIOR + ladder_rows.UNPROJECTED, refine=REFINED, compare_with=["pgsr"]),
    Row("rgb", "default, photos as exposed", "default", ["data.exposure=false"], refine=REFINED, compare_with=["default", "3dgs", "pgsr"]),
    Row("rgb", "default, without bare planes", "default", refine=["--no-bare-planes"], compare_with=["default"]),
    Row("rgb", "default, multi-view terms", "default", ladder_rows.MULTI_VIEW, refine=REFINED, compare_with=["default"]),
    Row("rgb", "default, from the points", "default", compare_with=["3dgs", "pgsr"]),
    Row("rgb", "default, from the points, MCMC growth", "default", ["densify.strategy=mcmc"], compare_with=["default, from the points"]),
    Row("simulated", "3dgs", "paper", ladder_rows.THREE_DGS),
    Row("simulated", "pgsr + prior depth", "pgsr", ladder_rows.PGSR_PRIOR, compare_with=["3dgs"]),
    Row("simulated", "pgsr + prior depth, refined cameras", "pgsr", ladder_rows.PGSR_PRIOR, ladder_rows.CAMERAS_ONLY),
    Row("simulated", "default, not refined", "default", compare_with=["3dgs", "pgsr + prior depth"]),
    Row("simulated", "default", "default", refine=REFINED,
        compare_with=["3dgs", "pgsr + prior depth", "pgsr + prior depth, refined cameras", "default, not refined"]),
    Row("rgbd", "default", "default"),
    *[Row(source, f"default, {change}", "default", settings, refine=refine, compare_with=["default"])
      for source, refine in (("rgb", REFINED), ("simulated", REFINED), ("rgbd", None)) for change, settings in CHANGES.items()],
]
# Rows of the ladder of rooms that a capture without labels cannot have.
NEED_LABELS = ["+ L_sem, uncoupled", "+ L_sem, coupled", "+ L_ng + L_nb (paper)", "default, planes of walls, floor and ceiling"]
WHY_EMPTY = ("Empty rows need labels. The capture has none, and networks that would make them need their published weights; "
             "a simulated teacher needs true labels, which the capture does not have either.")
NO_COLUMNS = ("miou", "teacher", "miou_present", "teacher_present", "mesh_miou",  # no labels
              "between", "beyond", "posed")  # no test photo looks beyond the training photos
# Meshes that no training has touched, with the cameras of the row beside them.
YARDSTICKS = {
    "rgb: default": [("rgb: TSDF of the measured depth", "--from-prior", REFINED)],
    "simulated: default": [("simulated: TSDF of the prior depth, cameras as given", "--from-prior", None),
                           ("simulated: TSDF of the prior depth, refined cameras", "--from-prior", ladder_rows.CAMERAS_ONLY),
                           ("simulated: TSDF of the refined depth", "--from-prior", REFINED),
                           ("simulated: TSDF of the true depth (ceiling)", "--from-truth", REFINED)],
}


def base_scene(arguments, source, seed):
    scenes = arguments.output / "scenes"
    if source == "simulated":
        folder = scenes / f"simulated_{seed}"
        if not folder.exists():
            ladder.run("data", "simulate", base_scene(arguments, "rgbd", seed), "-o", folder, "--seed", seed)
        return folder
    folder = scenes / source
    if not folder.exists():
        ladder.run("import", arguments.capture, "-o", folder, *(["--sfm", arguments.sfm] if source == "rgb" else []))
    return folder


def scene_of(arguments, source, seed, refine):
    scene = base_scene(arguments, source, seed)
    return scene if refine is None else ladder.refined_scene(scene, refine)


def train(arguments, row, seed):
    folder = arguments.output / "runs" / str(seed) / row.folder
    result = ladder.trained(folder, lambda: scene_of(arguments, row.source, seed, row.refine), row, arguments.iterations, seed,
                            [f"data.scale={arguments.scale}"])
    shutil.rmtree(folder / "checkpoints", ignore_errors=True)
    return result


def measure(arguments, seed, yardstick):
    _, option, refine = yardstick
    scene = scene_of(arguments, yardstick[0].split(":")[0], seed, refine)
    folder = arguments.output / "runs" / str(seed) / ("yardstick_" + scene.name)
    return ladder.mesh_scores(folder, scene, option, "default", seed, [f"data.scale={arguments.scale}"])


def write_tables(arguments, results):
    ladder_tables.write_csv(arguments.output / "results.csv", ["seed"], results)
    columns = [c for c in ladder_rows.COLUMNS if c[0] not in NO_COLUMNS]
    lines = [f"A real capture, {arguments.iterations} iterations at {arguments.scale:g} of the photos' resolution, means over the seeds. "
             "A seed of `rgb` and `rgbd` is another draw of training, one of `simulated` (**simulated** cameras, depth and points) another "
             "draw of both.", "", "| row | seeds | " + " | ".join(title for _, title, *_ in columns) + " |", "|---" * (len(columns) + 2) + "|"]
    for name, by_seed in results.items():
        cells = [ladder_tables.mean_cell([v[key] for v in by_seed.values()], digits) for key, _, digits, _ in columns]
        lines.append(f"| {name} | {len(by_seed)} | " + " | ".join(cells) + " |")
    for source in ("rgb", "simulated"):
        lines += [f"| {source}: {name} | 0 | " + " | ".join("–" for _ in columns) + " |" for name in NEED_LABELS]
    lines += ["", WHY_EMPTY, "", "Paired differences, mean and 95 % interval over seeds:", "", "| row | against | PSNR (dB) | F | F, aligned |",
              "|---|---|---|---|---|"]
    for row in ROWS:
        for base in (b for b in row.compare_with if b in results and row.name in results):
            cells = [ladder_tables.difference_cell(results, row.name, base, key, digits) for key, digits in (("psnr", 2), ("fscore", 3), ("aligned", 3))]
            lines.append(f"| {row.name} | {base} | " + " | ".join(cells) + " |")
    (arguments.output / "table.md").write_text("\n".join(lines) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("capture", type=Path)
    parser.add_argument("output", type=Path)
    parser.add_argument("--sfm", type=Path, required=True)
    parser.add_argument("--seeds", nargs="+", type=int, default=[1, 2, 3])
    parser.add_argument("--iterations", type=int, default=2000)
    parser.add_argument("--scale", type=float, default=0.5)
    parser.add_argument("--rows", nargs="+", default=None, help="only these rows (names as in the table)")
    arguments = parser.parse_args()
    (arguments.output / "scenes").mkdir(parents=True, exist_ok=True)
    ladder.write_settings(arguments.output, {"iterations": arguments.iterations, "scale": arguments.scale},
                          {r.name: {"preset": r.preset, "set": r.settings, "refine": r.refine} for r in ROWS})
    results = ladder_tables.read_csv(arguments.output / "results.csv", ["seed"])
    for seed in arguments.seeds:
        for row in (r for r in ROWS if arguments.rows is None or r.name in arguments.rows):
            if (seed,) not in results.setdefault(row.name, {}):
                print(f"seed {seed}: {row.name}", flush=True)
                results[row.name][(seed,)] = train(arguments, row, seed)
                write_tables(arguments, results)
            for yardstick in YARDSTICKS.get(row.name, []):
                if (seed,) not in results.setdefault(yardstick[0], {}):
                    results[yardstick[0]][(seed,)] = measure(arguments, seed, yardstick)
                    write_tables(arguments, results)
        ladder.write_page([arguments.output / "runs" / str(seed) / row.folder for row in ROWS], arguments.output / f"{seed}.html")
    print((arguments.output / "table.md").read_text())


if __name__ == "__main__":
    main()
