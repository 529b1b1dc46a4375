#!/usr/bin/env python3
"""Draws meshes of a room from its test views and compares them with the photos, as a Markdown table.

    benchmarks/quality/mesh_views.py RUN FILE.glb [FILE.glb...] [--pictures FOLDER]

RUN is a run folder with renders/test. The files are exports of its mesh (`aligngs export RUN -f glb --mesh-only`), with or without
a texture, in the frame of room.json where the run has it. They are read and drawn here, without the program. --pictures writes
what was drawn, and the room from above. Needs Debian's python3-numpy and python3-pil."""
import argparse
import io
import json
import struct
from pathlib import Path

import numpy as np
from PIL import Image

FINER = 2      # samples per pixel and axis: splats are smoothed over a pixel, too
NEAR = 0.02    # metres: what is nearer to the camera is cut off
TYPES = {5126: "<f4", 5125: "<u4", 5123: "<u2", 5121: "u1"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


def srgb(linear):
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055)


class Mesh:
    """All triangles of a GLB: corner positions, and corner colours or texture coordinates."""

    def __init__(self, file):
        data = Path(file).read_bytes()
        length = struct.unpack_from("<I", data, 12)[0]
        document, start = json.loads(data[20:20 + length]), 20 + length + 8

        def view(index):
            v = document["bufferViews"][index]
            return data[start + v.get("byteOffset", 0):start + v.get("byteOffset", 0) + v["byteLength"]]

        def values(index):
            a = document["accessors"][index]
            return np.frombuffer(view(a["bufferView"]), TYPES[a["componentType"]], a["count"] * WIDTHS[a["type"]]).reshape(a["count"], -1)

        positions, values_of_corners = [], []
        self.texture = None
        if document.get("images"):
            self.texture = np.asarray(Image.open(io.BytesIO(view(document["images"][0]["bufferView"]))).convert("RGB"), dtype=np.float32) / 255
        for mesh in document["meshes"]:
            for p in mesh["primitives"]:
                if p.get("mode", 4) != 4:
                    continue
                corners = values(p["indices"]).reshape(-1)
                positions.append(values(p["attributes"]["POSITION"])[corners])
                if self.texture is not None:
                    values_of_corners.append(values(p["attributes"]["TEXCOORD_0"])[corners])
                else:
                    values_of_corners.append(srgb(values(p["attributes"]["COLOR_0"])[corners, :3] / 65535.0))
        self.positions = np.concatenate(positions).astype(np.float64).reshape(-1, 3, 3)
        self.values = np.concatenate(values_of_corners).astype(np.float64)
        self.values = self.values.reshape(len(self.positions), 3, -1)

    def color(self, value):
        if self.texture is None:
            return value
        h, w, _ = self.texture.shape
        x, y = np.clip(value[:, 0] * w - 0.5, 0, w - 1), np.clip(value[:, 1] * h - 0.5, 0, h - 1)
        x0, y0 = x.astype(int), y.astype(int)
        x1, y1 = np.minimum(x0 + 1, w - 1), np.minimum(y0 + 1, h - 1)
        fx, fy = (x - x0)[:, None], (y - y0)[:, None]
        t = self.texture
        return (1 - fy) * ((1 - fx) * t[y0, x0] + fx * t[y0, x1]) + fy * ((1 - fx) * t[y1, x0] + fx * t[y1, x1])


def clipped(points, values):
    """Triangles in front of the plane z = NEAR; those that cross it are cut."""
    inside = points[:, :, 2] > NEAR
    count = inside.sum(axis=1)
    out_p, out_v = [points[count == 3]], [values[count == 3]]
    for wanted in (1, 2):
        chosen = count == wanted
        p, v, i = points[chosen], values[chosen], inside[chosen]
        alone = np.argmax(i if wanted == 1 else ~i, axis=1)
        rows = np.arange(len(p))
        order = (alone[:, None] + np.arange(3)) % 3
        p, v = p[rows[:, None], order], v[rows[:, None], order]

        def cut(a, b):
            t = ((NEAR - p[:, a, 2]) / (p[:, b, 2] - p[:, a, 2]))[:, None]
            return p[:, a] + t * (p[:, b] - p[:, a]), v[:, a] + t * (v[:, b] - v[:, a])
        (p1, v1), (p2, v2) = cut(0, 1), cut(0, 2)
        if wanted == 1:
            out_p.append(np.stack([p[:, 0], p1, p2], 1)), out_v.append(np.stack([v[:, 0], v1, v2], 1))
        else:
            out_p += [np.stack([p1, p[:, 1], p[:, 2]], 1), np.stack([p1, p[:, 2], p2], 1)]
            out_v += [np.stack([v1, v[:, 1], v[:, 2]], 1), np.stack([v1, v[:, 2], v2], 1)]
    return np.concatenate(out_p), np.concatenate(out_v)


def draw(mesh, rotation, translation, fx, fy, cx, cy, width, height, below=None, parallel=False):
    """RGB, zero where nothing is drawn. Camera axes: x right, y down, z forward. `below`: leave out triangles nearer than this."""
    points, values = mesh.positions @ rotation.T + translation, mesh.values
    if below is not None:
        kept = points[:, :, 2].min(axis=1) > below
        points, values = points[kept], values[kept]
    if not parallel:
        points, values = clipped(points, values)
    depth = np.ones_like(points[:, :, 2]) if parallel else points[:, :, 2]
    x, y = fx * points[:, :, 0] / depth + cx, fy * points[:, :, 1] / depth + cy
    x0, x1 = np.clip(np.ceil(x.min(1) - 0.5), 0, width).astype(int), np.clip(np.floor(x.max(1) - 0.5) + 1, 0, width).astype(int)
    y0, y1 = np.clip(np.ceil(y.min(1) - 0.5), 0, height).astype(int), np.clip(np.floor(y.max(1) - 0.5) + 1, 0, height).astype(int)
    area = (x[:, 1] - x[:, 0]) * (y[:, 2] - y[:, 0]) - (x[:, 2] - x[:, 0]) * (y[:, 1] - y[:, 0])
    columns, rows = np.maximum(x1 - x0, 0), np.maximum(y1 - y0, 0)
    cells = np.where(np.abs(area) > 1e-12, columns * rows, 0)
    nearest, picture = np.full(width * height, np.inf), np.zeros((width * height, 3))
    step, first = 4_000_000, 0
    ends = np.cumsum(cells)
    while first < len(cells):
        last = max(first + 1, np.searchsorted(ends, (ends[first - 1] if first else 0) + step))
        part = np.arange(first, min(last, len(cells)))
        first = last
        t = np.repeat(part, cells[part])
        if len(t) == 0:
            continue
        k = np.arange(len(t)) - np.repeat(np.cumsum(cells[part]) - cells[part], cells[part])
        px, py = x0[t] + k % columns[t], y0[t] + k // columns[t]
        weights = []
        for i in range(3):
            a, b = (i + 1) % 3, (i + 2) % 3
            weights.append(((x[t, b] - x[t, a]) * (py + 0.5 - y[t, a]) - (px + 0.5 - x[t, a]) * (y[t, b] - y[t, a])) / area[t])
        weights = np.stack(weights, 1)
        hit = (weights >= 0).all(axis=1)
        t, px, py, weights = t[hit], px[hit], py[hit], weights[hit]
        if parallel:
            z = (weights * points[t, :, 2]).sum(1)
        else:
            weights = weights / points[t, :, 2]
            z = 1 / weights.sum(1)
            weights = weights * z[:, None]
        pixel = py * width + px
        order = np.lexsort((z, pixel))
        front = order[np.concatenate([[True], pixel[order][1:] != pixel[order][:-1]])] if len(order) else order
        front = front[z[front] < nearest[pixel[front]]]
        nearest[pixel[front]] = z[front]
        picture[pixel[front]] = mesh.color((weights[front, :, None] * values[t[front]]).sum(1))
    return picture.reshape(height, width, 3)


def coarser(picture):
    h, w, _ = picture.shape
    return picture.reshape(h // FINER, FINER, w // FINER, FINER, 3).mean(axis=(1, 3))


def psnr(a, b):
    return -10 * np.log10(np.mean((a - b) ** 2))


def to_file(run):
    """Rows of the 3 x 4 motion from the scene's world to that of the file, and its scale."""
    room = run / "room.json"
    if not room.exists():
        raise SystemExit(f"mesh_views.py: {room} is missing: make it with aligngs room")
    rows = np.array(json.loads(room.read_text())["frame"]["world_to_room"])[:3]
    rows = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]]) @ rows  # z up to y up
    return rows, np.cbrt(np.linalg.det(rows[:, :3]))


def save(folder, name, picture):
    folder.mkdir(parents=True, exist_ok=True)
    Image.fromarray((np.clip(picture, 0, 1) * 255 + 0.5).astype(np.uint8)).save(folder / name)


def above(mesh, folder, name):
    """The room from above, without what hangs in its upper fifth."""
    low, high = mesh.positions.reshape(-1, 3).min(0), mesh.positions.reshape(-1, 3).max(0)
    size = 900 / max(high[0] - low[0], high[2] - low[2])
    rotation = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0.0]])  # looking down
    cut = -high[1] + 0.2 * (high[1] - low[1])
    save(folder, name, draw(mesh, rotation, np.zeros(3), size, size, -size * low[0], -size * low[2], int(size * (high[0] - low[0])) + 1,
                            int(size * (high[2] - low[2])) + 1, below=cut, parallel=True))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("run", type=Path)
    parser.add_argument("files", type=Path, nargs="+")
    parser.add_argument("--pictures", type=Path)
    options = parser.parse_args()
    renders = options.run / "renders" / "test"
    cameras = [c for c in json.loads((options.run / "cameras.json").read_text()) if c["split"] == "test"]
    truth = {c["img_name"]: np.asarray(Image.open(renders / "gt" / (c["img_name"] + ".png")).convert("RGB")) / 255.0 for c in cameras}
    splats = [psnr(np.asarray(Image.open(renders / "rgb" / (c["img_name"] + ".png")).convert("RGB")) / 255.0, truth[c["img_name"]]) for c in cameras]
    print("| file | triangles | MB | PSNR (dB) | beside the splats |")
    print("|---|---|---|---|---|")
    print(f"| splats | | | {np.mean(splats):.2f} | |")
    motion, scale = to_file(options.run)
    for file in options.files:
        mesh = Mesh(file)
        scores = []
        for camera in cameras:
            # Camera to world, then to the file: x_file = scale R x_world + t.
            back = np.array(camera["rotation"])
            to_world = motion[:, :3] @ back / scale
            centre = motion[:, :3] @ np.array(camera["position"]) + motion[:, 3]
            picture = truth[camera["img_name"]]
            factor = FINER * picture.shape[1] / camera["width"]
            drawn = coarser(draw(mesh, to_world.T, -to_world.T @ centre, factor * camera["fx"], factor * camera["fy"], factor * camera["cx"],
                                 factor * camera["cy"], FINER * picture.shape[1], FINER * picture.shape[0]))
            scores.append(psnr(drawn, picture))
            if options.pictures:
                save(options.pictures, f"{file.stem}_{camera['img_name']}.png", drawn)
        if options.pictures:
            above(mesh, options.pictures, f"{file.stem}_above.png")
        print(f"| {file.name} | {len(mesh.positions)} | {file.stat().st_size / 1e6:.2f} | {np.mean(scores):.2f} | {np.mean(scores) - np.mean(splats):+.2f} |")


if __name__ == "__main__":
    main()
