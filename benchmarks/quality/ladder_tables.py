"""Summaries of the ladder: means, paired differences with intervals, files of them."""
import csv
import math
import random
import re

from ladder_rows import COLUMNS, CONTROLS, PAIR, ROWS, YARDSTICKS


def interval(by_pair, draws=10000):
    """Mean and 95 % interval of {pair: difference}, and how many are known: percentile bootstrap with a fixed seed. A pair is what makes its
    scene and, last, the draw. Scenes are drawn first, and then the draws within each: three draws of one room are not three rooms."""
    values = {pair: d for pair, d in by_pair.items() if math.isfinite(d)}
    if not values:
        return math.nan, math.nan, math.nan, 0
    by_scene = {}
    for (*scene, _), value in values.items():
        by_scene.setdefault(tuple(scene), []).append(value)
    scenes, generator, means = list(by_scene.values()), random.Random(1), []
    for _ in range(draws):
        drawn = [value for scene in generator.choices(scenes, k=len(scenes)) for value in generator.choices(scene, k=len(scene))]
        means.append(sum(drawn) / len(drawn))
    means.sort()
    return sum(values.values()) / len(values), means[int(0.025 * draws)], means[int(0.975 * draws) - 1], len(values)


def number(value, digits):
    return f"{value:.{digits}f}" if math.isfinite(value) else "–"


def mean(values):
    finite = [v for v in values if math.isfinite(v)]
    return sum(finite) / len(finite) if finite else math.nan


def mean_cell(values, digits):
    """The mean; where some pairs lack the number and others have it, of how many."""
    finite = sum(math.isfinite(v) for v in values)
    return number(mean(values), digits) + (f" (of {finite})" if 0 < finite < len(values) else "")


def difference_cell(results, row, base, key, digits):
    pairs = {k: results[row][k][key] - results[base][k][key] for k in results[row] if k in results[base]}
    middle, low, high, count = interval(pairs)
    if count == 0:
        return "–"
    if all(d == 0 for d in pairs.values()):
        return "0 (the same to the last digit)"
    noise = " (noise)" if count < 3 or low <= 0 <= high else ""
    return f"{middle:+.{digits}f} [{low:+.{digits}f}, {high:+.{digits}f}]{noise}"


def read_csv(file, key_columns):
    """{row: {values of the key columns: scores}}; numbers among the keys are whole. Empty without the file."""
    results = {}
    if file.exists():
        with open(file, newline="") as text:
            for line in csv.DictReader(text):
                key = tuple(int(line[k]) if line[k].isdigit() else line[k] for k in key_columns)
                results.setdefault(line["row"], {})[key] = {k: float(line.get(k) or "nan") for k, *_ in COLUMNS}
    return results


def write_csv(file, key_columns, results):
    with open(file, "w", newline="") as text:
        writer = csv.writer(text)
        writer.writerow(["row", *key_columns] + [key for key, *_ in COLUMNS])
        for name, by_key in results.items():
            for keys, values in by_key.items():
                writer.writerow([name, *keys] + ["" if math.isnan(values[k]) else values[k] for k, *_ in COLUMNS])


def in_order(results):
    """Rows as ladder_rows.py lists them, yardsticks behind."""
    order = [r.name for r in ROWS]
    return dict(sorted(results.items(), key=lambda item: order.index(item[0]) if item[0] in order else len(order)))


def write_tables(arguments, results):
    output = arguments.output
    results = in_order(results)
    write_csv(output / "results.csv", PAIR, results)
    lines = [f"{arguments.rooms} rooms, {arguments.iterations} iterations, {arguments.size}, 20 training and 8 test views, **simulated** "
             "teachers of the medium level. Means over the pairs of room and seed, of which there are as many as the second column says. "
             "Processor seconds are those of `run`, without `refine` before it.", "", *mean_lines(results), "",
             "Paired differences, mean and 95 % interval over rooms and the seeds of each:", "", *difference_lines(results)]
    lines += gap_lines(results) + acceptance_lines(output / "acceptance")
    (output / "table.md").write_text("\n".join(lines) + "\n")


def mean_line(name, by_pair, columns=COLUMNS):
    return f"| {name} | {len(by_pair)} | " + " | ".join(mean_cell([v[key] for v in by_pair.values()], digits) for key, _, digits, _ in columns) + " |"


def rows_on_common_pairs(results):
    """If most rows that lack pairs have the same few, the other rows on these pairs: means of different pairs do not compare."""
    counts = [len(by_pair) for by_pair in results.values()]
    fewer = [n for n in counts if n < max(counts)]
    if not fewer:
        return {}
    usual = max(set(fewer), key=lambda n: (fewer.count(n), n))
    common = set.intersection(*(set(by_pair) for by_pair in results.values() if len(by_pair) == usual))
    return {name: {k: by_pair[k] for k in common} for name, by_pair in results.items() if common and len(by_pair) > usual and common <= set(by_pair)}


def common_lines(results, columns=COLUMNS):
    return [mean_line(f"{name}, the pairs of shorter rows", by_pair, columns) for name, by_pair in rows_on_common_pairs(results).items()]


def mean_lines(results, columns=COLUMNS):
    """The table of means, its head included."""
    return (["| row | pairs | " + " | ".join(title for _, title, *_ in columns) + " |", "|---" * (len(columns) + 2) + "|"] +
            [mean_line(name, by_pair, columns) for name, by_pair in results.items()] + common_lines(results, columns))


DIFFERENCES = (("psnr", 2), ("fscore", 3))  # and mIoU, where labels mean something


def difference_cells(results, row, base):
    """PSNR, F and mIoU."""
    meaningless = {r.name for r in ROWS if r.labels in ("constant", "shuffled")}  # labels that nobody asks to be right
    cells = [difference_cell(results, row, base, *column) for column in DIFFERENCES]
    return cells + ["–" if {row, base} & meaningless else difference_cell(results, row, base, "miou", 3)]


def difference_lines(results):
    """The table of paired differences, its head included."""
    lines = ["| row | against | PSNR (dB) | F | mIoU |", "|---|---|---|---|---|"]
    for row, base in [(r.name, b) for r in ROWS for b in r.compare_with]:
        if base in results and row in results:
            lines.append(f"| {row} | {base} | " + " | ".join(difference_cells(results, row, base)) + " |")
    return lines


def room_lines(results, base):
    """Gain of every other row over one row, with the table's head. It has intervals and rooms, as a mean hides a room that is hurt."""
    rooms = sorted({room for room, *_ in results.get(base, {})})
    lines = [f"| against `{base}` | pairs | PSNR (dB) | F | mIoU | PSNR: {', '.join(rooms)} | F |", "|---" * 7 + "|"]
    for row in (name for name in results if name != base):
        common = [k for k in results[row] if k in results.get(base, {})]
        if not any(math.isfinite(results[row][k]["psnr"] - results[base][k]["psnr"]) for k in common):
            continue  # a mesh alone
        cells = difference_cells(results, row, base)
        for key, digits in DIFFERENCES:
            each = [mean([results[row][k][key] - results[base][k][key] for k in common if k[0] == room]) for room in rooms]
            cells.append(", ".join(f"{d:+.{digits}f}" if math.isfinite(d) else "–" for d in each))
        lines.append(f"| {row} | {len(common)} | " + " | ".join(cells) + " |")
    return lines


def summary_line(title, by_pair, digits):
    """Mean, interval, smallest pair and the mean of every room."""
    middle, low, high, count = interval(by_pair)
    rooms = {}
    for (room, *_), value in by_pair.items():
        rooms.setdefault(room, []).append(value)
    each = ", ".join(f"{room} {mean(values):.{digits}f}" for room, values in sorted(rooms.items()))
    return f"{title}: {middle:.{digits}f} [{low:.{digits}f}, {high:.{digits}f}], smallest {min(by_pair.values()):.{digits}f}, over {count} pairs ({each})."


def gap_lines(results):
    """Gain of a row over the meshes that no training has touched, its share of the way to the ceiling, and its labels against the
    teacher's."""
    lines = []
    for row, (first, *between, last) in YARDSTICKS.items():
        own, prior, ceiling = (results.get(name, {}) for name in (row, first.name, last.name))
        gains = {k: v["miou"] - v["teacher"] for k, v in own.items() if math.isfinite(v["miou"] - v["teacher"])}
        if gains:
            lines += ["", summary_line(f"mIoU of `{row}` less that of the teacher on the test photos", gains, 3)]
        shares = {k: (own[k]["fscore"] - prior[k]["fscore"]) / (ceiling[k]["fscore"] - prior[k]["fscore"])
                  for k in own if k in prior and k in ceiling and ceiling[k]["fscore"] > prior[k]["fscore"]}
        if shares:
            lines += ["", summary_line(f"(F - F_prior) / (F_ceiling - F_prior) of `{row}`", shares, 2)]
        for yard in between:
            over = {k: own[k]["fscore"] - results[yard.name][k]["fscore"] for k in own if k in results.get(yard.name, {})}
            if over:
                lines += ["", summary_line(f"F of `{row}` less that of `{yard.name}`", over, 3)]
    for row, controls in CONTROLS.items():
        placebos = [results[p] for p in controls if p in results]
        for key, title, digits in (("fscore", "F", 3), ("psnr", "PSNR (dB)", 2)):
            over = {k: v[key] - max(p[k][key] for p in placebos) for k, v in results.get(row, {}).items()
                    if placebos and all(k in p for p in placebos)}
            if over:
                middle, low, high, count = interval(over)
                lines += ["", f"{title} of `{row}` over the best of {len(placebos)} controls of each pair: {middle:+.{digits}f} "
                          f"[{low:+.{digits}f}, {high:+.{digits}f}] over {count} pairs."]
    return lines


# A line of what `aligngs synth` measures of its teachers: name, value, unit, range of real networks, verdict.
MEASURED = re.compile(r"^  (\S.*?)\s{2,}([\d.]+)( \S+)?\s{2,}(\S.*?)\s{2,}(ok|outside)\s*$")


def acceptance_lines(folder):
    """How the simulated teachers of the scenes compare with real networks: the mean of each figure, and in how many scenes it is inside."""
    figures = {}
    for file in sorted(folder.glob("*.txt")):
        for name, value, unit, wanted, verdict in (m.groups() for m in map(MEASURED.match, file.read_text().splitlines()) if m):
            figures.setdefault((name, (unit or "").strip(), wanted), []).append((float(value), verdict == "ok"))
    if not figures:
        return []
    lines = ["", "What the simulated teachers measure (means over the scenes; `acceptance/` has each), beside the ranges of real networks:", "",
             "| figure | mean | range | scenes inside |", "|---|---|---|---|"]
    for (name, unit, wanted), measured in figures.items():
        lines.append(f"| {name} | {number(mean([v for v, _ in measured]), 3)} {unit} | {wanted} | {sum(ok for _, ok in measured)} of {len(measured)} |")
    return lines
