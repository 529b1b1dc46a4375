#!/usr/bin/env python3
"""Compares walls, floor and ceiling of a room.json with planes of a reference mesh.

    benchmarks/quality/room_planes.py RUN MESH --poses FOLDER      a Markdown table

RUN is a run folder with room.json. MESH is a binary PLY of triangles in metres. FOLDER has NAME.txt with 4 x 4 camera-to-world matrices
in the mesh's frame; the cameras of RUN/sparse are laid on them without scale, so that errors of the scale count. Planes are fitted here,
without the program: the surfaces of the mesh within BAND of a surface of the room that face alike, the peak of their distances, and
least squares with Tukey's weights around it. "Behind" is what the mesh shows more than BEHIND beyond a wall, in its rectangle: a wall
with much behind it is no wall. Needs numpy."""
import argparse
import json
from pathlib import Path

import numpy as np
import room_accuracy

BAND = 0.30      # metres on either side of a surface in which planes are looked for
FACING = 0.9     # cosine between the normals
PEAK = 0.02      # metres: width of the bins that the peak is found in
TUKEY = 0.05     # metres, from which a point has no weight
INSET = 0.05     # metres that the sides of a rectangle leave out: corners are round
LEAST = 0.10     # square metres of mesh that a plane needs
BEHIND = 0.15    # metres beyond a wall that are another surface
FARTHEST = 1.50  # and up to which it is asked for
TYPES = {"char": "i1", "uchar": "u1", "short": "<i2", "ushort": "<u2", "int": "<i4", "uint": "<u4", "float": "<f4", "double": "<f8",
         "int8": "i1", "uint8": "u1", "int32": "<i4", "uint32": "<u4", "float32": "<f4", "float64": "<f8"}


def read_mesh(path):
    """Vertices and triangles of a binary little-endian PLY."""
    data = Path(path).read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    elements = []
    for line in data[:end].decode("ascii").split("\n"):
        words = line.split()
        if words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        elif words[:2] == ["property", "list"]:
            elements[-1][2].extend([("count", TYPES[words[2]]), ("indices", TYPES[words[3]], (3,))])
        elif words[:1] == ["property"]:
            elements[-1][2].append((words[2], TYPES[words[1]]))
    arrays = {}
    for name, count, fields in elements:
        kind = np.dtype(fields)
        arrays[name] = np.frombuffer(data, kind, count, end)
        end += kind.itemsize * count
    if len(arrays["face"]) and np.any(arrays["face"]["count"] != 3):
        raise ValueError(f"{path}: faces that are no triangles")
    return np.stack([arrays["vertex"][axis] for axis in "xyz"], 1).astype(float), arrays["face"]["indices"].astype(int)


def surfaces_of(vertices, triangles):
    """Centres, unit normals and areas of triangles."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    doubled = np.linalg.norm(normals, axis=1)
    kept = doubled > 0
    return ((a + b + c) / 3)[kept], (normals[kept].T / doubled[kept]).T, doubled[kept] / 2


def fit(points, areas, distances):
    """Centre and unit normal of the plane around the peak of the distances: least squares with Tukey's weights."""
    bins = np.arange(-BAND - PEAK, BAND + 2 * PEAK, PEAK)
    counts, _ = np.histogram(distances, bins, weights=areas)
    counts = np.convolve(counts, [1, 2, 1], "same")
    residuals = distances - (bins[np.argmax(counts)] + PEAK / 2)
    centre = normal = None
    for _ in range(20):
        weights = areas * np.where(np.abs(residuals) < TUKEY, (1 - (residuals / TUKEY) ** 2) ** 2, 0)
        if weights.sum() < LEAST / 4:
            return None
        centre = weights @ points / weights.sum()
        offsets = points - centre
        normal = np.linalg.eigh((offsets * weights[:, None]).T @ offsets)[1][:, 0]
        residuals = offsets @ normal
    return centre, normal


def inside(polygon, points):
    """Whether points lie in a polygon seen from above."""
    result = np.zeros(len(points), bool)
    for (ax, ay), (bx, by) in zip(polygon, np.roll(polygon, -1, 0)):
        if ay == by:
            continue
        crosses = (points[:, 1] < ay) != (points[:, 1] < by)
        result ^= crosses & (points[:, 0] < ax + (points[:, 1] - ay) / (by - ay) * (bx - ax))
    return result


def compared(surfaces, normal, offset, within):
    """What the mesh says of normal . x + offset = 0 where `within`: distance of its plane into the room, angle, area near, area behind."""
    points, normals, areas = surfaces
    distances = points @ normal + offset
    alike = within & (np.abs(normals @ normal) > FACING)
    near = alike & (np.abs(distances) < BAND)
    behind = float(areas[alike & (distances < -BEHIND) & (distances > -FARTHEST)].sum())
    found = fit(points[near], areas[near], distances[near]) if areas[near].sum() >= LEAST else None
    if found is None:
        return {"distance": None, "angle": None, "area": float(areas[near].sum()), "behind": behind}
    centre, own = found
    close = near & (np.abs((points - centre) @ own) < TUKEY)
    return {"distance": float(centre @ normal + offset), "angle": float(np.degrees(np.arccos(min(1.0, abs(own @ normal))))),
            "area": float(areas[close].sum()), "behind": behind}


def compare(room, surfaces):
    """Results by surface. `surfaces`: of the mesh, in the room's frame."""
    points = surfaces[0]
    outline = np.array([wall["from"] for wall in room["walls"]])
    above = inside(outline, points[:, :2])
    results = {"floor": compared(surfaces, np.array([0, 0, 1.0]), 0.0, above) | {"assumed": room["floor"]["assumed"]}}
    height = room["measures"]["ceiling_height"]
    results["ceiling"] = compared(surfaces, np.array([0, 0, -1.0]), height, above) | {"assumed": room["ceiling"]["assumed"]}
    for wall in room["walls"]:
        a, b = np.array(wall["from"]), np.array(wall["to"])
        along = (b - a) / np.linalg.norm(b - a)
        t = (points[:, :2] - a) @ along
        within = (t > INSET) & (t < np.linalg.norm(b - a) - INSET) & (points[:, 2] > INSET) & (points[:, 2] < wall["height"] - INSET)
        results[wall["id"]] = compared(surfaces, np.array(wall["plane"][:3]), wall["plane"][3], within) | {"assumed": wall["assumed"]}
    return results


def table(results):
    cell = lambda value, factor, digits: "–" if value is None else f"{factor * value:.{digits}f}"
    lines = ["| surface | assumed | distance of the mesh's plane, cm | angle, degrees | mesh on it, m² | mesh behind it, m² |", "|---" * 6 + "|"]
    for name, r in results.items():
        lines.append(f"| {name} | {'yes' if r['assumed'] else 'no'} | {cell(r['distance'], 100, 1)} | {cell(r['angle'], 1, 1)} | "
                     f"{r['area']:.2f} | {r['behind']:.2f} |")
    walls = [abs(r["distance"]) for n, r in results.items() if n.startswith("wall") and not r["assumed"] and r["distance"] is not None]
    if walls:
        lines.append(f"\nwalls that were seen: median {100 * np.median(walls):.1f} cm, worst {100 * max(walls):.1f} cm")
    low, high = results["floor"]["distance"], results["ceiling"]["distance"]
    if results["floor"]["assumed"] or results["ceiling"]["assumed"]:
        lines.append("the height is assumed: no photo shows both floor and ceiling")
    elif low is not None and high is not None:
        lines.append(f"ceiling height off by {100 * abs(low + high):.1f} cm")
    return "\n".join(lines)


def to_room_of(run, poses, room):
    """Rotation and translation of the mesh's frame to the room's, with the scale of room.json."""
    own = room_accuracy.camera_centres(run / "sparse/0")
    exact = {path.stem: np.loadtxt(path)[:3, 3].tolist() for path in poses.glob("*.txt")}
    names = [name for name in own if Path(name).stem in exact]
    motion, scale = room_accuracy.rigid_fit([exact[Path(n).stem] for n in names], [own[n] for n in names])
    motion, matrix = np.array(motion), np.array(room["frame"]["world_to_room"])[:3]
    return matrix[:, :3] @ motion[:, :3], matrix[:, :3] @ motion[:, 3] + matrix[:, 3], 1 / scale


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", type=Path)
    parser.add_argument("mesh", type=Path)
    parser.add_argument("--poses", type=Path, required=True)
    arguments = parser.parse_args()
    room = json.loads((arguments.run / "room.json").read_text())
    linear, shift, scale = to_room_of(arguments.run, arguments.poses, room)
    vertices, triangles = read_mesh(arguments.mesh)
    print(table(compare(room, surfaces_of(vertices @ linear.T + shift, triangles))))
    print(f"scale of the cameras off by {100 * (scale - 1):.2f} %")


if __name__ == "__main__":
    main()
