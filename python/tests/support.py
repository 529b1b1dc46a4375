"""Small files for the tests: a run folder, a scene's arrays, a program that stands in for aligngs."""
import json
import os
import struct
from pathlib import Path

import numpy as np

FAKE_PROGRAM = """#!/bin/sh
source=$2
[ "$1" = demo ] && source=good
while [ $# -gt 0 ]; do
  [ "$1" = -o ] && run=$2
  shift
done
mkdir -p "$run"
case $source in
  good)
    for step in 1 2 3; do echo "{\\"step\\": $step}" >>"$run/events.ndjson"; done
    echo '{"status": "done", "stage": "done"}' >"$run/run.json" ;;
  bad)
    printf '{\\n  "error": {"status": 3, "message": "no photos", "path": "/p", "field": "f", "remedy": "take some"}\\n}\\n'
    exit 3 ;;
  silent) echo "it broke" >&2; exit 1 ;;
  killed) kill -9 $$ ;;
  status*) exit ${source#status} ;;
esac
"""


def write_fake_program(folder):
    path = Path(folder) / "fake_aligngs"
    path.write_text(FAKE_PROGRAM)
    os.chmod(path, 0o755)
    return path


def gaussian_ply(labelled):
    """Two splats as the program writes them; f_rest_0 to f_rest_44 are 0, 1, 2, ... in the first one."""
    names = ["x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2", *(f"f_rest_{i}" for i in range(45)), "opacity",
             "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"]
    header = "ply\nformat binary_little_endian 1.0\ncomment SplatRenderMode: default\nelement vertex 2\n"
    header += "".join(f"property float {name}\n" for name in names)
    if labelled:
        header += "property ushort label\nproperty ushort instance\nproperty uchar confidence\n"
    rows = b""
    for i in range(2):
        floats = [1 + i, 2, 3, 0, 0, 0, 0.1, 0.2, 0.3, *(range(45) if i == 0 else [0] * 45), 0, 0, 1, 2, 1, 0, 0, 0]
        rows += struct.pack("<62f", *floats) + (struct.pack("<HHB", i, 7, 255) if labelled else b"")
    return header.encode() + b"end_header\n" + rows


def mesh_ply():
    header = ("ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
              "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty ushort label\n"
              "element face 1\nproperty list uchar int vertex_indices\nend_header\n")
    rows = b"".join(struct.pack("<3f3BH", i, 0, 0, 10, 20, 30, i) for i in range(3))
    return header.encode() + rows + struct.pack("<B3i", 3, 0, 1, 2)


def write_run(folder):
    folder = Path(folder)
    (folder / "mesh").mkdir(parents=True)
    (folder / "scene.ply").write_bytes(gaussian_ply(False))
    (folder / "scene.labels.ply").write_bytes(gaussian_ply(True))
    (folder / "mesh" / "mesh.ply").write_bytes(mesh_ply())
    camera = {"id": 0, "img_name": "0000", "width": 4, "height": 3, "position": [1, 2, 3], "rotation": [[0, -1, 0], [1, 0, 0], [0, 0, 1]],
              "fx": 5, "fy": 6, "cx": 2, "cy": 1.5, "split": "test"}
    for name, value in (("run.json", {"status": "done", "stage": "done"}), ("metrics.json", {"nvs": {"psnr": 21.5}}), ("cameras.json", [camera]),
                        ("classes.json", {"classes": [{"id": i, "name": n, "synonyms": [], "gaussians": 1} for i, n in enumerate(["wall", "bed"])]})):
        (folder / name).write_text(json.dumps(value))
    return folder


def scene_arrays(count=3, height=6, width=8):
    rng = np.random.default_rng(1)
    images = [rng.integers(0, 255, (height, width, 3), np.uint8) for _ in range(count)]
    poses = [np.eye(4) for _ in range(count)]
    for i, pose in enumerate(poses):
        pose[0, 3] = i
    return images, poses
