#!/usr/bin/env python3
"""Kills every command at random moments, or gives it too small a disk, and runs the same command again.

    tests/reliability/series.py kill OUTPUT [--trials 100] [--seed 1]
    tests/reliability/series.py disk OUTPUT [--trials 20] [--seed 1]        (root: it mounts a small tmpfs)

A trial is right when the second call ends with the bytes of an undisturbed call. It is right, too, if a message names a remedy that works.
Nothing half-written may bear the name of an output. OUTPUT/kill.csv or disk.csv has a line per trial. ALIGNGS names the program
(default build/aligngs). docs/reliability.md has the results."""
import argparse
import csv
import hashlib
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

PROGRAM = os.environ.get("ALIGNGS", str(Path(__file__).resolve().parents[2] / "build" / "aligngs"))
# Figures of a run that depend on the clock, and names of folders. Checkpoints hold the seconds spent.
CLOCKED = ("seconds", "time", "wall", "peak", "memory", "_ms", "per_second", "date", "created", "folder", "command", "resumed", "rate", "host", "pid")
NOT_COMPARED = ("events.ndjson", "report.html", "run.json", "train.log", "control", "checkpoints")


class Command:
    """A command in a folder that holds `room` (a scene) and, for most, `run` (a trained run). `again`: what the message of the second
    call names when the first one has left something; tried then."""

    def __init__(self, name, arguments, outputs, again=None):
        self.name, self.arguments, self.outputs, self.again = name, arguments, outputs, again


SMALL = ["--size", "160x120", "--views", "8", "--test-views", "2"]
COMMANDS = [
    Command("synth", ["synth", "made", *SMALL], ["made"], "--overwrite"),
    Command("data simulate", ["data", "simulate", "room", "-o", "made"], ["made"], "--overwrite"),
    Command("import", ["import", "colmap", "-o", "made"], ["made"], "--overwrite"),
    Command("poses", ["poses", "colmap/images", "--method", "given", "-o", "made"], ["made"], "--overwrite"),
    Command("refine", ["refine", "room", "-o", "made"], ["made"], "--overwrite"),
    Command("train", ["train", "room", "-o", "made", "-n", "60", "--set", "checkpoint.every=20"], ["made"], "--resume"),
    Command("run", ["run", "room", "-o", "made", "-n", "40", "--no-refine", "--set", "mesh.voxel=0.05"], ["made"], "--resume"),
    Command("mesh", ["mesh", "run", "-o", "mesh_made.ply"], ["mesh_made.ply"]),
    Command("eval", ["eval", "run"], ["run/metrics.json"]),
    Command("render", ["render", "run", "--split", "train"], ["run/renders/train"]),
    Command("export", ["export", "run", "-f", "glb", "-o", "made.glb"], ["made.glb"]),
    Command("export sog", ["export", "run", "-f", "sog", "-o", "made.sog"], ["made.sog"]),
    Command("export html", ["export", "run", "-f", "html", "-o", "made.html"], ["made.html"]),
    Command("edit", ["edit", "run", "--select", "bed", "--delete"], ["run/edits.json", "run/edits"]),
    Command("room", ["room", "run"], ["run/room.json"]),
    Command("report", ["report", "run"], ["run/overview.jpg"]),
    Command("compare", ["compare", "run", "run", "--html", "made.html", "--csv", "made.csv"], ["made.html", "made.csv"]),
    Command("scale", ["scale", "run", "--between", "0,0,0", "0.5,0,0", "0.9"], ["run/room.json"]),
    Command("poses da3", ["poses", "room/images", "--method", "da3", "--poses-model", "da3-small", "--metres", "none", "-o", "made"], ["made"], "--overwrite"),
    Command("priors", ["priors", "plain", "-o", "made", "--semantics", "linear-s", "--depth", "none"], ["made"], "--overwrite"),
    Command("models import", ["models", "import", "da3-small", "models/da3-small/model.safetensors"], ["imported"]),
]
# These use weights of full size with random values, which `random_weights` writes.
NEED_WEIGHTS = ("poses da3", "priors", "models import")


def without_clock(value):
    if isinstance(value, dict):
        return {k: without_clock(v) for k, v in value.items() if not any(word in k for word in CLOCKED)}
    return [without_clock(v) for v in value] if isinstance(value, list) else value


def digest(path):
    """Digest of the files below, by name; JSON without the parts that depend on the clock."""
    found = {}
    files = [path] if path.is_file() else sorted(p for p in path.rglob("*") if p.is_file()) if path.exists() else []
    for file in files:
        name = str(file.relative_to(path)) if file != path else ""
        if any(part in NOT_COMPARED for part in file.parts[len(path.parts):]) or file.suffix == ".csv":
            continue
        data = file.read_bytes()
        if file.suffix == ".json":
            try:
                data = json.dumps(without_clock(json.loads(data)), sort_keys=True).encode()
            except ValueError:
                pass
        found[name] = hashlib.sha256(data).hexdigest()
    return found


def state(folder, command):
    return {output: digest(folder / output) for output in command.outputs}


def temporary_files(folder):
    return [str(p.relative_to(folder)) for p in folder.rglob("*.tmp-*")]


def start(folder, arguments):
    models = "imported" if arguments[0] == "models" else "models"
    environment = {**os.environ, "ALIGNGS_MODELS": str(folder / models), "HF_HOME": str(folder / "no"), "TORCH_HOME": str(folder / "no")}
    return subprocess.Popen([PROGRAM, *arguments, "-q"], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, env=environment)


def call(folder, arguments):
    process = start(folder, arguments)
    message = process.communicate()[1]
    return process.returncode, message


def fresh(prepared, folder):
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(prepared, folder)


def prepare(output):
    """A small scene, the same as a COLMAP data set, and a trained run."""
    prepared = output / "prepared"
    if (prepared / "run" / "metrics.json").exists():
        return prepared
    shutil.rmtree(prepared, ignore_errors=True)
    prepared.mkdir(parents=True)
    for arguments in (["synth", "room", *SMALL], ["run", "room", "-o", "run", "-n", "100", "--no-refine", "--set", "mesh.voxel=0.05"]):
        status, message = call(prepared, arguments)
        if status:
            sys.exit(message)
    for folder in ("images", "sparse"):
        shutil.copytree(prepared / "room" / folder, prepared / "colmap" / folder)
    shutil.copytree(prepared / "colmap", prepared / "plain")
    random_weights = Path(PROGRAM).parent / "benchmarks" / "random_weights"
    if random_weights.exists():
        subprocess.run([random_weights, prepared / "models", "da3-small", "ade20k-linear-s"], check=True, stdout=subprocess.DEVNULL)
    return prepared


def undisturbed(output, prepared, command):
    """Outputs and seconds of a call that nothing disturbs; calls twice, for what does not repeat itself cannot be compared."""
    folder, states, seconds = output / "work", [], 0
    for _ in range(2):
        fresh(prepared, folder)
        begin = time.time()
        status, message = call(folder, command.arguments)
        seconds = time.time() - begin
        if status:
            sys.exit(f"{command.name}: {message}")
        states.append(state(folder, command))
    differing = [f"{o}/{f}" for o in states[0] for f in states[0][o] if states[1][o].get(f) != states[0][o][f]]
    if differing:
        sys.exit(f"{command.name}: two calls differ in {differing[:5]}")
    return states[0], seconds


def second_call(folder, command, wanted):
    """The outcome of the same command again: 'same bytes', 'message, same bytes', or what went wrong."""
    status, message = call(folder, command.arguments)
    said = ""
    if status and state(folder, command) == wanted:
        return "message, same bytes"  # the first call had done all of it
    if status:
        if not command.again or command.again not in message:
            return f"status {status}: {message.strip()[:300]}"
        said = "message, "
        status, message = call(folder, [*command.arguments, command.again])
        if status:
            return f"{command.again}: status {status}: {message.strip()[:300]}"
    found = state(folder, command)
    if found != wanted:
        files = [f"{o}/{f}" for o in wanted for f in set(wanted[o]) | set(found[o]) if wanted[o].get(f) != found[o].get(f)]
        return f"other bytes: {files[:4]}"
    return said + "same bytes"


def kill_trial(folder, command, seconds, choose):
    process = start(folder, command.arguments)
    moment = choose.uniform(0, seconds)
    try:
        process.wait(moment)
    except subprocess.TimeoutExpired:
        pass
    process.send_signal(signal.SIGKILL)
    process.wait()
    return f"{moment:.2f} s of {seconds:.2f}", ""


def disk_trial(folder, command, choose):
    """The folder lies on a tmpfs with little room left."""
    used = sum(p.stat().st_size for p in folder.rglob("*") if p.is_file())
    room = choose.randrange(20_000, max(40_000, command.writes))
    subprocess.run(["mount", "-o", f"remount,size={(used + room) // 4096 * 4096 + 400_000}", str(folder.parent)], check=True)
    status, message = call(folder, command.arguments)
    left = temporary_files(folder)
    subprocess.run(["mount", "-o", "remount,size=2G", str(folder.parent)], check=True)
    problem = ""
    if status and "space" not in message.lower() and "full" not in message.lower():
        problem = f"status {status} without the reason: {message.strip()[:200]}"
    if status and left:
        problem = f"left {left[:3]}"
    return f"{room} bytes left, status {status}", problem


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kind", choices=["kill", "disk"])
    parser.add_argument("output", type=Path)
    parser.add_argument("--trials", type=int)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--commands", nargs="+", help="only these commands (their names in the table)")
    arguments = parser.parse_args()
    trials = arguments.trials or (100 if arguments.kind == "kill" else 20)
    output = arguments.output.resolve()
    commands = [c for c in COMMANDS if arguments.commands is None or c.name in arguments.commands]
    prepared, choose = prepare(output), random.Random(arguments.seed)
    if not (prepared / "models").exists():
        commands = [c for c in commands if c.name not in NEED_WEIGHTS]
    wanted = {}
    small = output / "small"
    if arguments.kind == "disk":
        small.mkdir(exist_ok=True)
        subprocess.run(["mount", "-t", "tmpfs", "-o", "size=2G", "tmpfs", str(small)], check=True)
    bad = 0
    try:
        with open(output / f"{arguments.kind}.csv", "w", newline="") as file:
            table = csv.writer(file)
            table.writerow(["trial", "command", "moment", "outcome"])
            for trial in range(trials):
                command = commands[trial % len(commands)]
                if command.name not in wanted:
                    wanted[command.name] = undisturbed(output, prepared, command)
                    command.writes = sum((output / "work" / o).stat().st_size if (output / "work" / o).is_file() else
                                         sum(p.stat().st_size for p in (output / "work" / o).rglob("*") if p.is_file()) for o in command.outputs)
                reference, seconds = wanted[command.name]
                folder = small / "work" if arguments.kind == "disk" else output / "work"
                fresh(prepared, folder)
                moment, problem = disk_trial(folder, command, choose) if arguments.kind == "disk" else kill_trial(folder, command, seconds, choose)
                outcome = problem or second_call(folder, command, reference)
                bad += "same bytes" not in outcome
                table.writerow([trial, command.name, moment, outcome])
                file.flush()
                print(trial, command.name, moment, outcome, flush=True)
    finally:
        if arguments.kind == "disk":
            subprocess.run(["umount", str(small)], check=False)
    print(f"{trials} trials, {bad} wrong")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
