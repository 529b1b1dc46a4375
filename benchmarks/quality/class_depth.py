#!/usr/bin/env python3
"""How wrong the prior or refined depth of scenes is on the true pixels of some classes, and on all others.

    benchmarks/quality/class_depth.py SCENE... [--classes television monitor "crt screen"] [--views]

SCENE is a scene folder with truth/depth and truth/labels, as `aligngs synth` writes it and `aligngs refine` takes it over. It
prints for each the median absolute error of the training photos' depth in millimetres, and the share of the pixels within 5 cm.
--views adds the median signed error of each photo that shows such a class (positive: too far). Needs nothing but Python."""
import argparse
import array
import ast
import json
import statistics
import struct
import zlib
from pathlib import Path

# Numbers among the 150 classes of ADE20K (src/scene/ade20k_labels.cpp).
CLASSES = {"wall": 0, "windowpane": 8, "painting": 22, "mirror": 27, "television": 89, "poster": 100, "screen": 130,
           "crt screen": 141, "monitor": 143, "bulletin board": 144}
SCREENS = ["television", "monitor", "crt screen"]
NEAR = 0.05  # metres: the threshold of the F-score


def read_depth(path):
    """Width, height, values of a two-dimensional float32 .npy."""
    data = path.read_bytes()
    if data[:6] != b"\x93NUMPY":
        raise ValueError(f"{path}: no .npy file")
    length = struct.unpack("<H", data[8:10])[0]
    header = ast.literal_eval(data[10:10 + length].decode("latin1").strip())
    if header["descr"] != "<f4" or header["fortran_order"]:
        raise ValueError(f"{path}: not float32 in C order")
    values = array.array("f", data[10 + length:])
    height, width = header["shape"][-2:]
    return width, height, values


def unfilter(kind, row, above, step):
    if kind == 1:
        for i in range(step, len(row)):
            row[i] = (row[i] + row[i - step]) & 255
    elif kind == 2:
        for i in range(len(row)):
            row[i] = (row[i] + above[i]) & 255
    elif kind == 3:
        for i in range(len(row)):
            row[i] = (row[i] + ((row[i - step] if i >= step else 0) + above[i]) // 2) & 255
    elif kind == 4:
        for i in range(len(row)):
            a, b, c = (row[i - step] if i >= step else 0), above[i], (above[i - step] if i >= step else 0)
            p = a + b - c
            pa, pb, pc = abs(p - a), abs(p - b), abs(p - c)
            row[i] = (row[i] + (a if pa <= pb and pa <= pc else b if pb <= pc else c)) & 255
    return row


def read_grey_png(path):
    """Width, height, values of a PNG of one channel, 8 or 16 bits, not interlaced."""
    data = path.read_bytes()
    at, packed = 8, b""
    while at < len(data):
        size, name = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if name == b"IHDR":
            width, height, bits, color, _, _, interlaced = struct.unpack(">IIBBBBB", body)
            if color not in (0, 3) or bits not in (8, 16) or interlaced:
                raise ValueError(f"{path}: not one channel of 8 or 16 bits")
        elif name == b"IDAT":
            packed += body
        at += 12 + size
    raw, step = zlib.decompress(packed), bits // 8
    line, above, values = width * step, bytearray(width * step), []
    for y in range(height):
        begin = y * (line + 1)
        above = unfilter(raw[begin], bytearray(raw[begin + 1:begin + 1 + line]), above, step)
        values.extend(above if step == 1 else ((above[i] << 8) | above[i + 1] for i in range(0, line, 2)))
    return width, height, values


def errors_of(scene, classes):
    """Per photo signed errors in metres: {name: (on the classes, on all else)}."""
    wanted = {CLASSES[name] for name in classes}
    out = {}
    for name in json.loads((scene / "split.json").read_text())["train"]:
        width, height, depth = read_depth(scene / "pred_depths" / f"{name}.npy")
        true_width, true_height, true = read_grey_png(scene / "truth" / "depth" / f"{name}.png")
        labels = read_grey_png(scene / "truth" / "labels" / f"{name}.png")[2]
        if (width, height) != (true_width, true_height):
            raise ValueError(f"{scene}: prior depth of {name} has not the size of the true depth")
        on, off = [], []
        for z, truth, label in zip(depth, true, labels):
            if truth > 0 and z > 0:
                (on if label in wanted else off).append(z - truth / 1000)
        out[name] = (on, off)
    return out


def summary(values):
    if not values:
        return "          –"
    sizes = [abs(v) for v in values]
    return f"{1000 * statistics.median(sizes):6.1f} mm, {sum(s < NEAR for s in sizes) / len(sizes):.3f} within 5 cm"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", type=Path)
    parser.add_argument("--classes", nargs="+", default=SCREENS, choices=sorted(CLASSES))
    parser.add_argument("--views", action="store_true")
    arguments = parser.parse_args()
    for scene in arguments.scenes:
        errors = errors_of(scene, arguments.classes)
        on, off = ([e for pair in errors.values() for e in pair[k]] for k in (0, 1))
        print(f"{scene.name:32} {', '.join(arguments.classes)}: {summary(on)} ({len(on)} pixels); all else: {summary(off)}")
        for name, (here, _) in errors.items():
            if arguments.views and here:
                print(f"    {name}: {1000 * statistics.median(here):8.1f} mm of {len(here)} pixels")


if __name__ == "__main__":
    main()
