#!/usr/bin/env python3
"""Times of edits and of their undo on the command line: wall time, processor time and peak memory of the process.

    benchmarks/edit_times.py RUN [--program build/aligngs] [--repeat 5] [--json FILE]

Works on a copy of the run. Best of the repetitions: what the machine does besides only adds.
"""

import argparse
import json
import os
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

EDITS = {
    "recolour a pillow": ["--select", "pillow", "--recolor", "#2e8b57"],
    "recolour the walls": ["--select", "wall", "--recolor", "#add8e6"],
    "delete the armchair, fill": ["--select", "armchair", "--delete", "--fill"],
    "delete the beds, fill": ["--select", "bed", "--delete", "--fill"],
    "move the armchair": ["--select", "armchair", "--move", "0.3,0,0"],
}


def measured(command):
    """Wall seconds, processor seconds and peak megabytes of a command, which must succeed."""
    begin = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    wall = time.monotonic() - begin
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        raise SystemExit(f"{' '.join(command)} ended with {process.returncode}")
    return {"wall": wall, "cpu": usage.ru_utime + usage.ru_stime, "megabytes": usage.ru_maxrss / 1024}


def best(results):
    return {name: min(result[name] for result in results) for name in results[0]}


def bytes_of(folder):
    return sum(file.stat().st_size for file in Path(folder).rglob("*") if file.is_file())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run")
    parser.add_argument("--program", default="build/aligngs")
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--json")
    options = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        run = Path(folder) / "run"
        shutil.copytree(options.run, run)
        for name, words in EDITS.items():
            edits, undos, size = [], [], 0
            for _ in range(options.repeat):
                edits.append(measured([options.program, "edit", str(run), "-q", *words]))
                size = bytes_of(run / "edits")
                undos.append(measured([options.program, "edit", str(run), "-q", "--undo"]))
            rows.append({"edit": name, "bytes": size, "do": best(edits), "undo": best(undos)})
            row = rows[-1]
            print(f"| {name} | {row['do']['wall']:.2f} ({row['do']['cpu']:.2f}) | {row['do']['megabytes']:.0f} "
                  f"| {row['undo']['wall']:.2f} ({row['undo']['cpu']:.2f}) | {row['undo']['megabytes']:.0f} | {size / 1e6:.2f} |", flush=True)
    if options.json:
        Path(options.json).write_text(json.dumps(rows, indent=2) + "\n")


if __name__ == "__main__":
    main()
