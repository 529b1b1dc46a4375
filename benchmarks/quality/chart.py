#!/usr/bin/env python3
"""Draws the ladder: F-score and PSNR of every row, a bar for the mean and a dot for every pair of room and seed.

    benchmarks/quality/chart.py OUTPUT chart.svg [ROW=LABEL...]

OUTPUT is a folder of ladder.py. With rows given, the chart has these rows alone, in this order and with these labels.
docs/images/results.svg, the chart of the README, is of three draws. Rows of default, of refined depth and of pgsr are those of
test_rooms/face_filter.csv, in a results.csv beside the others. It is made by

    benchmarks/quality/chart.py benchmarks/quality/test_rooms docs/images/results.svg \\
        "+ L_ng + L_nb (paper), refined cameras=preset paper" "stereo, no semantics=preset default without labels" \\
        "pgsr, the same scene=preset pgsr on the scene of default" \\
        "TSDF of the refined depth, no training=refined depth fused without training" "default, refined=preset default"
"""
import html
import math
import sys
from pathlib import Path

from ladder_rows import PAIR
from ladder_tables import mean, read_csv

LABEL, PANEL, GAP, LINE, TOP, BOTTOM = 345, 250, 36, 26, 34, 14  # pixels
PANELS = [("fscore", "F at 5 cm", 0.0, 1.0, 0.25, "{:.3f}"), ("psnr", "PSNR (dB)", 0.0, 30.0, 10.0, "{:.1f}")]
BAR, DOT, GRID, TEXT = "#8fb3d9", "#1f4e79", "#dddddd", "#222222"


def panel(results, index):
    """One panel as SVG elements. A row without this number (a mesh has no PSNR) has no bar."""
    key, title, low, high, step, form = PANELS[index]
    left = LABEL + index * (PANEL + GAP)
    bottom = TOP + LINE * len(results)

    def place(value):
        return left + PANEL * (min(max(value, low), high) - low) / (high - low)

    out = [f'<text x="{left}" y="16" font-weight="bold">{title}</text>']
    for k in range(round((high - low) / step) + 1):
        tick = low + k * step
        out.append(f'<line x1="{place(tick):.1f}" y1="{TOP - 4}" x2="{place(tick):.1f}" y2="{bottom}" stroke="{GRID}"/>')
        out.append(f'<text x="{place(tick):.1f}" y="{TOP - 6}" text-anchor="middle" font-size="10">{tick:g}</text>')
    for i, by_pair in enumerate(results.values()):
        numbers, y = [v[key] for v in by_pair.values() if math.isfinite(v[key])], TOP + LINE * i + LINE / 2
        if not numbers:
            continue
        out.append(f'<rect x="{left}" y="{y - 8:.1f}" width="{place(mean(numbers)) - left:.1f}" height="16" fill="{BAR}"/>')
        out += [f'<circle cx="{place(v):.1f}" cy="{y:.1f}" r="2.5" fill="{DOT}"/>' for v in numbers]
        out.append(f'<text x="{left + 4}" y="{y + 4:.1f}" font-size="11">{form.format(mean(numbers))}</text>')
    return out


def chart(results):
    width = LABEL + len(PANELS) * (PANEL + GAP)
    height = TOP + LINE * len(results) + BOTTOM
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" font-family="sans-serif" font-size="12" fill="{TEXT}">',
           f'<rect width="{width}" height="{height}" fill="white"/>']
    for i, (name, by_pair) in enumerate(results.items()):
        out.append(f'<text x="{LABEL - 8}" y="{TOP + LINE * i + LINE / 2 + 4:.1f}" text-anchor="end">{html.escape(name)} ({len(by_pair)})</text>')
    for index in range(len(PANELS)):
        out += panel(results, index)
    return "\n".join(out + ["</svg>"]) + "\n"


def chosen(results, choices):
    """The rows that ROW=LABEL names, under their labels; all rows without a choice."""
    pairs = [choice.rsplit("=", 1) for choice in choices]
    missing = [pair[0] for pair in pairs if len(pair) != 2 or pair[0] not in results]
    if missing:
        sys.exit(f"chart.py: no such row: {', '.join(missing)}")
    return {label: results[row] for row, label in pairs} if pairs else results


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    Path(sys.argv[2]).write_text(chart(chosen(read_csv(Path(sys.argv[1]) / "results.csv", PAIR), sys.argv[3:])))
