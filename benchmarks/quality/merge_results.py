#!/usr/bin/env python3
"""Puts together what ladder.py, or capture.py, measured in several places.

    benchmarks/quality/merge_results.py OUTPUT [PART...] [--docs docs/results.md]

OUTPUT and every PART are folders of one of the two. Figures of a PART replace those of the same row in OUTPUT or an earlier PART, pair by
pair of room and seed, or seed by seed. Rooms, iterations and size have to be the same. Writes results.csv, table.md, acceptance/
and settings.json of OUTPUT, whose "row programs" say which programs made a row. --docs makes the marked tables of that file anew.
They begin with <!-- OUTPUT: means -->, <!-- OUTPUT: differences --> or <!-- OUTPUT: rooms --> (differences to the whole default, room by
room) and end with <!-- OUTPUT: end -->. OUTPUT is the folder's name."""
import argparse
import json
import re
import shutil
import sys
from pathlib import Path
from types import SimpleNamespace

import capture
import ladder_tables
from ladder_rows import COLUMNS, PAIR
from ladder_tables import difference_lines, in_order, mean_lines, read_csv, room_lines

CONDITIONS = ("rooms", "iterations", "size", "teacher_seed", "scale")  # a ladder has no scale, a capture that and the iterations alone
LEFT_TO_TABLE_MD = ("area", "aligned", "miou_present", "teacher_present", "mesh_miou")


def merge(into, part):
    """Pair by pair; of each the results and the settings, which tell who made what. Both are changed in `into`."""
    for condition in CONDITIONS:
        if into["settings"].get("programs") and into["settings"].get(condition) != part["settings"].get(condition):
            raise ValueError(f"{condition} is {part['settings'].get(condition)} in one folder and {into['settings'].get(condition)} in another")
        if condition in part["settings"]:
            into["settings"][condition] = part["settings"][condition]
    made_by = into["settings"].setdefault("row programs", {})
    for row, by_pair in part["results"].items():
        before = into["results"].setdefault(row, {})
        kept = made_by.get(row, []) if set(before) - set(by_pair) else []
        new = part["settings"].get("row programs", {}).get(row, part["settings"]["programs"])
        made_by[row] = kept + [program for program in new if program not in kept]
        before.update(by_pair)
    if "note" in part["settings"]:
        into["settings"].setdefault("note", part["settings"]["note"])
    rows = into["settings"].setdefault("rows", {})
    rows.update({row: settings for row, settings in part["settings"]["rows"].items() if row in part["results"]})
    into["settings"]["programs"] = sorted({program for programs in made_by.values() for program in programs})


def put_together(parts):
    """Parts as one, later ones over earlier ones. Each is a name, for messages, and what merge() takes."""
    whole = {"settings": {}, "results": {}}
    for name, part in parts:
        try:
            merge(whole, part)
        except (KeyError, ValueError) as problem:
            sys.exit(f"{name}: {problem}")
    return whole


def is_capture(settings):
    return "scale" in settings


def read_folder(folder):
    settings = json.loads((folder / "settings.json").read_text())
    return {"settings": settings, "results": read_csv(folder / "results.csv", ("seed",) if is_capture(settings) else PAIR)}


def named(folder):
    """A folder as put_together() takes it; ends this script when it cannot be read."""
    try:
        return folder, read_folder(folder)
    except (OSError, KeyError, ValueError) as problem:
        sys.exit(f"{folder}: {problem}")


def write_tables(output, whole):
    conditions = {key: whole["settings"][key] for key in CONDITIONS if key in whole["settings"]}
    writer = capture if is_capture(whole["settings"]) else ladder_tables
    writer.write_tables(SimpleNamespace(output=output, **conditions), whole["results"])


def with_tables(text, folder_name, results):
    """The document with that folder's tables made anew; means without the columns that only table.md has."""
    columns = [c for c in COLUMNS if c[0] not in LEFT_TO_TABLE_MD]
    for name, lines in (("means", lambda: mean_lines(results, columns)), ("differences", lambda: difference_lines(results)),
                        ("rooms", lambda: room_lines(results, "default, refined"))):
        pattern = re.compile(rf"(<!-- {folder_name}: {name} -->\n).*?(<!-- {folder_name}: end -->)", re.S)
        text = pattern.sub(lambda m: m[1] + "\n".join(lines()) + "\n" + m[2], text)
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("output", type=Path)
    parser.add_argument("parts", type=Path, nargs="*")
    parser.add_argument("--docs", type=Path)
    arguments = parser.parse_args()
    output = arguments.output
    before = [named(output)] if (output / "settings.json").exists() else []
    # Parts first: only together may they replace a whole row, whose earlier programs are then forgotten.
    parts = [(", ".join(map(str, arguments.parts)), put_together(map(named, arguments.parts)))] if arguments.parts else []
    whole = put_together(before + parts)
    output.mkdir(parents=True, exist_ok=True)
    for file in (f for part in arguments.parts for f in sorted((part / "acceptance").glob("*.txt"))):
        (output / "acceptance").mkdir(exist_ok=True)
        shutil.copy(file, output / "acceptance")
    (output / "settings.json").write_text(json.dumps(whole["settings"], indent=2) + "\n")
    write_tables(output, whole)
    if arguments.docs:
        arguments.docs.write_text(with_tables(arguments.docs.read_text(), output.resolve().name, in_order(whole["results"])))


if __name__ == "__main__":
    main()
