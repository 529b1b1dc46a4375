#!/usr/bin/env python3
"""Exports a run in every format and prints size and time as a Markdown table.

    benchmarks/quality/export_table.py ALIGNGS RUN [FOLDER]

ALIGNGS is the program, RUN a run folder. The files are kept in FOLDER if it is given. Times are of the whole command, which first
opens the run, in seconds of all processors together: other programs on the machine change them little."""
import json
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

EXPORTS = [
    ("labels.ply", []),
    ("ply", []),
    ("splat", []),
    ("spz", []),
    ("sog", []),
    ("html", []),
    ("glb", []),
    ("glb", ["--splats-only"]),
    ("glb", ["--mesh-only"]),
    ("glb", ["--mesh-only", "--triangles", "100000"]),
    ("glb", ["--mesh-only", "--error", "5"]),
    ("glb", ["--mesh-only", "--triangles", "100000", "--closed"]),
    ("glb", ["--mesh-only", "--textured"]),
    ("glb", ["--mesh-only", "--textured", "--triangles", "20000"]),
    ("collision.glb", []),
    ("obj", []),
    ("obj", ["--textured"]),
    ("usda", []),
    ("usda", ["--mesh-only", "--textured"]),
    ("usdz", []),
    ("plan.svg", []),
    ("plan.dxf", []),
    ("plan.pdf", []),
]


def main():
    if len(sys.argv) not in (3, 4):
        raise SystemExit(__doc__)
    program, run = sys.argv[1:3]
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(sys.argv[3]) if len(sys.argv) == 4 else Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        print("| `-f` | options | MB | CPU seconds | triangles |")
        print("|---|---|---|---|---|")
        for number, (form, options) in enumerate(EXPORTS):
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            done = subprocess.run([program, "export", run, "-f", form, *options, "-o", str(folder / f"{number:02}.{form}"), "--json", "-q"], capture_output=True, text=True)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
            if done.returncode != 0:
                raise SystemExit(f"export_table.py: -f {form} {' '.join(options)}: {done.stderr.strip()}")
            report = json.loads(done.stdout)
            print(f"| `{form}` | {'`' + ' '.join(options) + '`' if options else ''} | {report['bytes'] / 1e6:.3g} | {seconds:.1f} | {report['triangles'] or ''} |", flush=True)


if __name__ == "__main__":
    main()
