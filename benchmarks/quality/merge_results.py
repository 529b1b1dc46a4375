#!/usr/bin/env python3
"""Puts together what ladder.py measured in several places.

    benchmarks/quality/merge_results.py OUTPUT [PART...] [--docs docs/quality.md]

OUTPUT and every PART are folders of ladder.py. What a PART has of a row takes the place of what OUTPUT or an earlier PART has of it, pair
by pair of room and seed. Rooms, iterations and size have to be the same. Writes results.csv, table.md, acceptance/ and settings.json
of OUTPUT, whose "row programs" say which programs made a row. With --docs the tables of that file between the lines
<!-- OUTPUT: means --> or <!-- OUTPUT: differences --> and <!-- OUTPUT: end --> are made anew, where OUTPUT is the folder's name."""
import argparse
import json
import re
import shutil
import sys
from pathlib import Path
from types import SimpleNamespace

from ladder_rows import COLUMNS, PAIR
from ladder_tables import difference_lines, in_order, mean_lines, read_csv, write_tables

CONDITIONS = ("rooms", "iterations", "size", "teacher_seed")
LEFT_TO_TABLE_MD = ("area", "aligned", "mesh_miou")


def merge(into, part):
    """Pair by pair; of each the results and the settings, which tell who made what. Both are changed in `into`."""
    for condition in CONDITIONS:
        if into["settings"].setdefault(condition, part["settings"].get(condition)) != part["settings"].get(condition):
            raise ValueError(f"{condition} is {part['settings'].get(condition)} in one folder and {into['settings'][condition]} in another")
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


def read_folder(folder):
    return {"settings": json.loads((folder / "settings.json").read_text()), "results": read_csv(folder / "results.csv", PAIR)}


def with_tables(text, folder_name, results):
    """The document with that folder's tables made anew; means without the columns that only table.md has."""
    columns = [c for c in COLUMNS if c[0] not in LEFT_TO_TABLE_MD]
    for name, lines in (("means", mean_lines(results, columns)), ("differences", difference_lines(results))):
        pattern = re.compile(rf"(<!-- {folder_name}: {name} -->\n).*?(<!-- {folder_name}: end -->)", re.S)
        text = pattern.sub(lambda m: m[1] + "\n".join(lines) + "\n" + m[2], text)
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("output", type=Path)
    parser.add_argument("parts", type=Path, nargs="*")
    parser.add_argument("--docs", type=Path)
    arguments = parser.parse_args()
    output = arguments.output
    whole = {"settings": {}, "results": {}}
    for folder in [f for f in [output] if (f / "settings.json").exists()] + arguments.parts:
        try:
            merge(whole, read_folder(folder))
        except (OSError, KeyError, ValueError) as problem:
            sys.exit(f"{folder}: {problem}")
    (output / "acceptance").mkdir(parents=True, exist_ok=True)
    for file in (f for part in arguments.parts for f in sorted((part / "acceptance").glob("*.txt"))):
        shutil.copy(file, output / "acceptance")
    (output / "settings.json").write_text(json.dumps(whole["settings"], indent=2) + "\n")
    conditions = {key: whole["settings"][key] for key in ("rooms", "iterations", "size")}
    write_tables(SimpleNamespace(output=output, **conditions), whole["results"])
    if arguments.docs:
        arguments.docs.write_text(with_tables(arguments.docs.read_text(), output.resolve().name, in_order(whole["results"])))


if __name__ == "__main__":
    main()
