#!/usr/bin/env python3
"""Copies the lines of ninja to standard output and adds to each how long the rest will take.

    NINJA_STATUS='[%f/%t] ' ninja ... | build_progress.py BUILD-FOLDER

The rest is told by the sizes of the sources that had no object at the start: half of the time goes into the largest
tenth of them, so that a count of objects would promise too little. A terminal has one line, which changes."""
import json
import os
import re
import sys
import time
from pathlib import Path

STATUS = re.compile(r"\[(\d+)/(\d+)\] (.*)")
OBJECT = re.compile(r"Building \S+ object (\S+)$")
BASE = 17000    # bytes: what the headers of any object cost, as bytes of source; fitted to a build of this tree
HEADERS = 55000  # bytes: what precompiling headers costs, likewise
EARLIEST = 10   # seconds: before, a guess would jump


def bytes_of_sources(source):
    """Of a source, or of those that a unit of a unity build includes."""
    if "Unity" not in source.parts:
        return source.stat().st_size
    return sum(Path(name).stat().st_size for name in re.findall(r'#include "([^"]+)"', source.read_text()) if Path(name).is_file())


def weights(folder):
    """Object that is missing -> its share of the work."""
    missing = {}
    for command in json.loads((folder / "compile_commands.json").read_text()):
        name = re.search(r" -o (\S+)", command["command"])
        source = Path(command["file"])
        if name and source.is_file() and not (folder / name[1]).exists():
            missing[name[1]] = HEADERS if name[1].endswith(".gch") else BASE + bytes_of_sources(source)
    return missing


def in_words(seconds):
    if seconds < 60:
        return f"{max(10, round(seconds, -1)):.0f} s"
    return f"{seconds / 60:.0f} min" if seconds >= 570 else f"{seconds / 60:.1f} min".replace(".0 ", " ")


class Progress:
    def __init__(self, left, now):
        self.left, self.start = dict(left), now
        self.total = sum(left.values())

    def told(self, line, now):
        """The line with its estimate; None where it is no status of ninja."""
        status = STATUS.match(line)
        if not status:
            return None
        finished = OBJECT.match(status[3])
        if finished:
            self.left.pop(finished[1], None)
        rest, elapsed = sum(self.left.values()), now - self.start
        estimate = ""
        if self.total and 0 < rest < self.total and elapsed >= EARLIEST:
            estimate = f", about {in_words(elapsed * rest / (self.total - rest))} left"
        return f"[{status[1]}/{status[2]}{estimate}] {status[3]}"


def main():
    folder = Path(sys.argv[1])
    try:
        missing = weights(folder)
    except (OSError, ValueError) as error:
        print(f"build_progress.py: no estimate of the time: {error}", file=sys.stderr)
        missing = {}
    progress, changing = Progress(missing, time.monotonic()), sys.stdout.isatty()
    open_line = False
    for line in sys.stdin:
        told = progress.told(line.rstrip("\n"), time.monotonic())
        if told is None:
            sys.stdout.write(("\n" if open_line else "") + line)
            open_line = False
        elif changing:
            width = os.get_terminal_size(sys.stdout.fileno()).columns or 80
            sys.stdout.write("\r\x1b[K" + told[:width - 1])
            open_line = True
        else:
            sys.stdout.write(told + "\n")
        sys.stdout.flush()
    if open_line:
        sys.stdout.write("\n")


if __name__ == "__main__":
    main()
