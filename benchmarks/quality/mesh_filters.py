#!/usr/bin/env python3
"""The effect of each part of mesh fusion: one trained run per scene, fused again with one setting changed at a time.

    benchmarks/quality/mesh_filters.py OUTPUT SCENE... [--iterations 1000] [--seed 1] [--set data.scale=0.5] [--variants NAME...]

SCENE is a scene folder with a true surface, as `benchmarks/quality/ladder.py` (with --keep-scenes) and `capture.py` leave them under
scenes/. --set is of the training. Finished runs and meshes in OUTPUT are not repeated. Writes mesh.csv (a line per scene and variant)
and mesh.md (means, and differences from the default with 95 % intervals over the scenes). ALIGNGS names the program (default
build/aligngs)."""
import argparse
import csv
import json
import math
from pathlib import Path

import ladder
import ladder_rows
import ladder_tables

DEFAULT = "default"
PAPER = ["mesh.depth=plane", "mesh.plane_reach=0", "mesh.smoothing=0", "mesh.tangent_distance=false", "mesh.alpha_min=0.5", "mesh.min_cosine=0", "mesh.single_view_weight=1", "mesh.contradicted_weight=1"]
BEFORE = ["mesh.depth=median", "mesh.plane_reach=0", "mesh.smoothing=0", "mesh.tangent_distance=false", "mesh.alpha_min=0.9", "mesh.min_cosine=0.17"]
# Name, settings of `aligngs mesh` and where its depth comes from.
VARIANTS = [
    (DEFAULT, [], None),
    ("no view consistency", ["mesh.single_view_weight=1", "mesh.contradicted_weight=1"], None),
    ("surface of one view as sure as any", ["mesh.single_view_weight=1"], None),
    ("surface of one view dropped", ["mesh.single_view_weight=0"], None),
    ("surface that others look through kept", ["mesh.contradicted_weight=1"], None),
    ("views agree within 2 % instead of 1 %", ["mesh.consistency=0.02"], None),
    ("half-transparent pixels kept (0.5)", ["mesh.alpha_min=0.5"], None),
    ("pixels below an alpha of 0.9 dropped", ["mesh.alpha_min=0.9"], None),
    ("grazing pixels kept", ["mesh.min_cosine=0"], None),
    ("pixels flatter than 80 degrees dropped", ["mesh.min_cosine=0.17"], None),
    ("walls, floor and ceiling as rendered", ["mesh.plane_reach=0"], None),
    ("not smoothed", ["mesh.smoothing=0"], None),
    ("smoothed over 8 pixels", ["mesh.smoothing=8"], None),
    ("distances along rays", ["mesh.tangent_distance=false"], None),
    ("holes up to 20 cm closed", ["mesh.max_hole=0.2"], None),
    ("small pieces kept", ["mesh.component_area=-1", "mesh.component_extent=-1"], None),
    ("pieces of 5 cm kept", ["mesh.component_area=0.0005", "mesh.component_extent=0.05"], None),
    ("median depth", ["mesh.depth=median"], None),
    ("plane depth", ["mesh.depth=plane"], None),
    ("plane depth within 2 %", ["mesh.depth_agreement=0.02"], None),
    ("as before: median depth as rendered, along rays", BEFORE, None),
    ("expected depth", ["mesh.depth=expected"], None),
    ("40 views between the training views", ["mesh.interpolated_views=40"], None),
    ("voxels of 5 mm", ["mesh.voxel=0.005"], None),
    ("all as preset paper", PAPER, None),
    ("depth before training", [], "--from-prior"),
    ("true depth, true cameras", [], "--from-truth"),
]
COLUMNS = [("accuracy", "Acc (m)", 4), ("completeness", "Comp (m)", 4), ("precision", "Prec", 3), ("recall", "Recall", 3), ("fscore", "F", 3),
           ("fscore_2cm", "F at 2 cm", 3), ("normals", "normals (deg)", 2), ("structure", "on structure", 2), ("pinholes", "pinholes", 4),
           ("coverage", "classes' surface", 3), ("miou", "mesh mIoU", 3)]


def scores(metrics):
    """`coverage`: the share of a class's true surface that the mesh comes near, mean over classes, so that thin ones count as walls do."""
    labels = (metrics.get("semantics") or {}).get("mesh") or {}
    parts = [v for v in (labels.get("class_coverage") or {}).values() if v is not None]
    keys = ("accuracy", "completeness", "precision", "recall", "fscore", "fscore_2cm", "normals", "structure", "pinholes")
    found = ladder.scores(metrics, keys)
    return {**{key: found[key] for key in keys},
            "coverage": sum(parts) / len(parts) if parts else math.nan, "miou": ladder.value_at(labels, "miou")}


def trained(arguments, scene):
    run = arguments.output / scene.name
    if not (run / "metrics.json").exists():
        ladder.run("run", scene, "-o", run, "--preset", "default", "-n", arguments.iterations, "--seed", arguments.seed, "--no-refine", "--overwrite",
                   *ladder.set_options([f"checkpoint.every={arguments.iterations}", *arguments.settings]))
    return run


def measure(run, name, settings, source):
    result = run / f"variant_{ladder_rows.file_name(name)}.json"
    if not result.exists():
        ladder.measure_mesh(run, result, *([source] if source else []), *ladder.set_options(settings))
    return scores(json.loads(result.read_text()))


def write_tables(output, results):
    with open(output / "mesh.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["variant", "scene", *(key for key, *_ in COLUMNS)])
        for name, by_scene in results.items():
            for scene, values in by_scene.items():
                writer.writerow([name, scene, *("" if math.isnan(values[key]) else values[key] for key, *_ in COLUMNS)])
    lines = ["| fusion | scenes | " + " | ".join(title for _, title, _ in COLUMNS) + " | F against the default |", "|---" * (len(COLUMNS) + 3) + "|"]
    for name, by_scene in results.items():
        cells = [ladder_tables.mean_cell([v[key] for v in by_scene.values()], digits) for key, _, digits in COLUMNS]
        cells.append("" if name == DEFAULT else ladder_tables.difference_cell(results, name, DEFAULT, "fscore", 4))
        lines.append(f"| {name} | {len(by_scene)} | " + " | ".join(cells) + " |")
    (output / "mesh.md").write_text("\n".join(lines) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("output", type=Path)
    parser.add_argument("scenes", type=Path, nargs="+")
    parser.add_argument("--iterations", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--set", dest="settings", action="append", default=[])
    parser.add_argument("--variants", nargs="+", choices=[name for name, *_ in VARIANTS[1:]], metavar="NAME", help="only these")
    arguments = parser.parse_args()
    arguments.output.mkdir(parents=True, exist_ok=True)
    results = {name: {} for name, *_ in VARIANTS}
    for scene in arguments.scenes:
        run = trained(arguments, scene)
        for name, settings, source in VARIANTS:
            if arguments.variants and name not in [DEFAULT, *arguments.variants]:
                continue
            print(f"{scene.name}: {name}", flush=True)
            results[name][scene.name] = measure(run, name, settings, source)
            write_tables(arguments.output, {n: r for n, r in results.items() if r})
    print((arguments.output / "mesh.md").read_text())


if __name__ == "__main__":
    main()
