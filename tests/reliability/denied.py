#!/usr/bin/env python3
"""Runs every command as a user who may not write where its output goes, and looks for what it leaves.

    tests/reliability/denied.py OUTPUT [--commands NAME...]        root: it starts the commands as another user

Three kinds of places, one trial of each per command:

    folder      the folder of the output belongs to somebody else
    output      the output is there, and it and all in it may be read alone
    source      the files that are read belong to somebody else, who lets nobody read them

A trial is right when the command ends with a status of errors, and its message names a place. Nothing in the folder may have changed: no
file, no folder, no temporary file. A command that writes nothing there, and so ends with status 0, is right where nothing changed as well.
OUTPUT/denied.csv has a line per trial. ALIGNGS names the program, which everybody may have to be able to run."""
import argparse
import csv
import hashlib
import os
import subprocess
import sys
from pathlib import Path

from commands import COMMANDS, PROGRAM, call, fresh, prepare, temporary_files

NOBODY = 65534
ERRORS = (1, 2, 3, 5)
SECONDS = 300


def everything(folder):
    """Each file and folder below with what it holds; what the trial itself sets, such as owners, is left out."""
    found = {}
    for place in sorted(folder.rglob("*")):
        name = str(place.relative_to(folder))
        if place.is_symlink():
            found[name] = os.readlink(place)
        else:
            found[name] = "folder" if place.is_dir() else hashlib.sha256(place.read_bytes()).hexdigest()
    return found


def all_of(place):
    return [place, *place.rglob("*")] if place.exists() else []


def give(places, owner, mode):
    """`mode`: bits for files; folders get the bits to enter them where they may be read."""
    for place in places:
        if place.is_symlink():
            continue
        os.chown(place, owner, owner)
        enter = (mode & 0o444) >> 2
        place.chmod(mode | enter if place.is_dir() else mode)


def deny(kind, folder, command):
    """Sets the rights of a trial. Whether the trial says something about this command."""
    if kind == "folder":
        give(all_of(folder), 0, 0o644)
        return True
    outputs = [folder / Path(output).parts[0] for output in command.outputs]
    if kind == "output":
        give(all_of(folder), NOBODY, 0o644)
        for output in outputs:
            give(all_of(output), NOBODY, 0o444)
        return any(output.exists() for output in outputs)
    give(all_of(folder), NOBODY, 0o644)
    sources = [folder / word for word in command.arguments if (folder / word).exists() and folder / word not in outputs]
    for source in sources:
        give(all_of(source), 0, 0o600)
    return bool(sources)


def start_as_nobody(folder, arguments):
    environment = {**os.environ, "ALIGNGS_MODELS": str(folder / "models"), "HOME": "/nonexistent"}
    words = ["setpriv", f"--reuid={NOBODY}", f"--regid={NOBODY}", "--clear-groups", PROGRAM, *arguments, "-q"]
    done = subprocess.run(words, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, env=environment, timeout=SECONDS, check=False)
    return done.returncode, done.stderr


def trial(folder, command, arguments):
    before = everything(folder)
    try:
        status, message = start_as_nobody(folder, arguments)
    except subprocess.TimeoutExpired:
        return "", f"does not end within {SECONDS} s"
    after = everything(folder)
    changed = [name for name in {**before, **after} if before.get(name) != after.get(name)]
    said = f"status {status}: {' '.join(message.split())[:300]}"
    if changed:
        return said, f"changed {sorted(changed)[:5]}"
    if temporary_files(folder):
        return said, "left a temporary file"
    if status and status not in ERRORS:
        return said, "another status"
    places = {*os.listdir(folder), *command.outputs}
    if status and not any("/" in word or word.strip(":,") in places for word in message.split()):
        return said, "names no place"
    return said, ""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("output", type=Path)
    parser.add_argument("--commands", nargs="+", help="only these commands (their names in commands.py)")
    arguments = parser.parse_args()
    output = arguments.output.resolve()
    prepared = prepare(output)
    folder = output / "work"
    trials = bad = 0
    with open(output / "denied.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(["command", "kind", "said", "problem"])
        for command in COMMANDS:
            if command.needs_weights or (arguments.commands and command.name not in arguments.commands):
                continue
            for kind in ("folder", "output", "source"):
                fresh(prepared, folder)
                words = list(command.arguments)
                if kind == "output" and not any((folder / Path(made).parts[0]).exists() for made in command.outputs):
                    if call(folder, words)[0]:  # the output of a first call
                        continue
                    words += [command.again] if command.again in ("--overwrite", "--resume") else []
                if not deny(kind, folder, command):
                    continue
                said, problem = trial(folder, command, words)
                trials += 1
                bad += bool(problem)
                table.writerow([command.name, kind, said, problem])
                file.flush()
                print(command.name, "|", kind, "|", problem or "right", "|", said, flush=True)
    print(f"{trials} trials, {bad} wrong")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
