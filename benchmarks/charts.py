#!/usr/bin/env python3
"""Draws the README's charts from the benchmark's JSON.

    engine_benchmark --benchmark_filter='^Step' --benchmark_out=step.json --benchmark_out_format=json
    benchmarks/charts.py step.json benchmarks/

writes time_pixels.svg, time_gaussians.svg and time_channels.svg. They have milliseconds of processor time per thread
of one step (solid) and the fastest wall time (dashed) along one size of the scene. The other sizes stay as in the
target scene (640 x 480 pixels, 200 000 Gaussians, 150 channels, all threads).
"""
import json
import re
import sys
from pathlib import Path

WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 360, 240, 52, 14, 28, 40
TARGET = {"width": 640, "gaussians": 200000, "channels": 150}
SEMANTICS = (25, 0)  # percent of the pixels, blended probabilities


def read_steps(path):
    """One dict per benchmarked scene."""
    steps = []
    for run in json.loads(Path(path).read_text())["benchmarks"]:
        match = re.match(r"Step/(\d+)/(\d+)/(\d+)/(\d+)/(\d+)/(\d+)/", run["name"])
        if not match:
            continue
        width, gaussians, channels, threads, percent, blend = map(int, match.groups())
        if (percent, blend) != SEMANTICS:
            continue
        steps.append({"width": width, "gaussians": gaussians, "channels": channels, "threads": threads,
                      "pixels": width * width * 3 // 4, "cpu": run["cpu_ms"], "wall": run["best_ms"]})
    return steps


def along(steps, key):
    """The scenes that differ from the target in `key` alone, in its order."""
    threads = max(s["threads"] for s in steps)
    others = [k for k in TARGET if k != key]
    chosen = [s for s in steps if s["threads"] == threads and all(s[k] == TARGET[k] for k in others)]
    return sorted(chosen, key=lambda s: s[key])


def ticks(limit):
    step = 10 ** (len(str(int(limit))) - 1)
    while limit / step < 3:
        step /= 2
    return [i * step for i in range(int(limit / step) + 1)]


def number(value):
    return f"{value / 1000:g}k" if value >= 1000 else f"{value:g}"


def chart(title, label, points):
    """points: (x, solid, dashed)."""
    x_limit = 1.05 * max(p[0] for p in points)
    y_limit = 1.1 * max(max(p[1], p[2]) for p in points)

    def at(x, y):
        return (LEFT + x / x_limit * (WIDTH - LEFT - RIGHT), HEIGHT - BOTTOM - y / y_limit * (HEIGHT - TOP - BOTTOM))

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" '
           f'viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="11">',
           f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>',
           f'<text x="{WIDTH / 2}" y="16" text-anchor="middle" font-size="12">{title}</text>']
    for y in ticks(y_limit):
        x0, y0 = at(0, y)
        out.append(f'<path d="M{x0:.1f} {y0:.1f}H{WIDTH - RIGHT}" stroke="#ddd"/>'
                   f'<text x="{x0 - 6:.1f}" y="{y0 + 4:.1f}" text-anchor="end">{number(y)}</text>')
    for x, _, _ in points:
        x0, y0 = at(x, 0)
        out.append(f'<text x="{x0:.1f}" y="{y0 + 15:.1f}" text-anchor="middle">{number(x)}</text>')
    for column, style in ((1, ""), (2, ' stroke-dasharray="5 4" opacity="0.6"')):
        path = " ".join("{:.1f},{:.1f}".format(*at(p[0], p[column])) for p in points)
        out.append(f'<polyline points="{path}" fill="none" stroke="#1f5fa8" stroke-width="2"{style}/>')
        if column == 1:
            out += ['<circle cx="{:.1f}" cy="{:.1f}" r="3" fill="#1f5fa8"/>'.format(*at(p[0], p[1])) for p in points]
    out.append(f'<text x="{(LEFT + WIDTH - RIGHT) / 2}" y="{HEIGHT - 6}" text-anchor="middle">{label}</text>')
    out.append(f'<text x="12" y="{HEIGHT / 2}" text-anchor="middle" transform="rotate(-90 12 {HEIGHT / 2})">ms per step</text>')
    return "\n".join(out + ["</svg>"]) + "\n"


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    steps = read_steps(sys.argv[1])
    folder = Path(sys.argv[2])
    for key, x, file, title, label in (
            ("width", "pixels", "time_pixels.svg", "Time against image size", "pixels"),
            ("gaussians", "gaussians", "time_gaussians.svg", "Time against Gaussians", "Gaussians"),
            ("channels", "channels", "time_channels.svg", "Time against semantic channels", "channels")):
        points = [(s[x], s["cpu"], s["wall"]) for s in along(steps, key)]
        if len(points) < 2:
            sys.exit(f"{sys.argv[1]}: fewer than two scenes along {key}; run every Step benchmark")
        (folder / file).write_text(chart(title, label, points))


if __name__ == "__main__":
    main()
