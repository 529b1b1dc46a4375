#!/usr/bin/env python3
"""Draws the ladder: F-score and PSNR of every row, a bar for the mean and a dot for every pair of room and seed.

    benchmarks/quality/chart.py OUTPUT/results.csv chart.svg
"""
import csv
import html
import math
import sys
from pathlib import Path

LABEL, PANEL, GAP, LINE, TOP, BOTTOM = 330, 250, 36, 26, 34, 14  # pixels
PANELS = [("fscore", "F at 5 cm", 0.0, 1.0, 0.25, "{:.3f}"), ("psnr", "PSNR (dB)", 0.0, 30.0, 10.0, "{:.1f}")]
BAR, DOT, GRID, TEXT = "#8fb3d9", "#1f4e79", "#dddddd", "#222222"


def read_rows(path):
    """{row: {column: [value of every pair]}} in the file's order."""
    rows = {}
    with open(path, newline="") as file:
        for line in csv.DictReader(file):
            values = rows.setdefault(line["row"], {key: [] for key, *_ in PANELS})
            for key in values:
                if line[key]:
                    values[key].append(float(line[key]))
    return rows


def panel(rows, index):
    """One panel as SVG elements. A row without this number (a mesh has no PSNR) has no bar."""
    key, title, low, high, step, form = PANELS[index]
    left = LABEL + index * (PANEL + GAP)
    bottom = TOP + LINE * len(rows)
    place = lambda value: left + PANEL * (min(max(value, low), high) - low) / (high - low)
    out = [f'<text x="{left}" y="16" font-weight="bold">{title}</text>']
    for k in range(round((high - low) / step) + 1):
        tick = low + k * step
        out.append(f'<line x1="{place(tick):.1f}" y1="{TOP - 4}" x2="{place(tick):.1f}" y2="{bottom}" stroke="{GRID}"/>')
        out.append(f'<text x="{place(tick):.1f}" y="{TOP - 6}" text-anchor="middle" font-size="10">{tick:g}</text>')
    for i, values in enumerate(rows.values()):
        numbers, y = values[key], TOP + LINE * i + LINE / 2
        if not numbers:
            continue
        mean = math.fsum(numbers) / len(numbers)
        out.append(f'<rect x="{left}" y="{y - 8:.1f}" width="{place(mean) - left:.1f}" height="16" fill="{BAR}"/>')
        out += [f'<circle cx="{place(v):.1f}" cy="{y:.1f}" r="2.5" fill="{DOT}"/>' for v in numbers]
        out.append(f'<text x="{left + 4}" y="{y + 4:.1f}" font-size="11">{form.format(mean)}</text>')
    return out


def chart(rows):
    width = LABEL + len(PANELS) * (PANEL + GAP)
    height = TOP + LINE * len(rows) + BOTTOM
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" font-family="sans-serif" font-size="12" fill="{TEXT}">',
           f'<rect width="{width}" height="{height}" fill="white"/>']
    for i, (name, values) in enumerate(rows.items()):
        pairs = max(len(numbers) for numbers in values.values())
        out.append(f'<text x="{LABEL - 8}" y="{TOP + LINE * i + LINE / 2 + 4:.1f}" text-anchor="end">{html.escape(name)} ({pairs})</text>')
    for index in range(len(PANELS)):
        out += panel(rows, index)
    return "\n".join(out + ["</svg>"]) + "\n"


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    Path(sys.argv[2]).write_text(chart(read_rows(sys.argv[1])))
