#!/usr/bin/env python3
"""Disturbs every command at random moments, and runs the same command again.

    tests/reliability/series.py kill OUTPUT [--trials 100] [--seed 1]       SIGKILL
    tests/reliability/series.py stop OUTPUT [--trials 100] [--seed 1]       Ctrl-C, SIGTERM, SIGHUP, Ctrl-C twice
    tests/reliability/series.py disk OUTPUT [--trials 20] [--seed 1]        a full disk (root: it mounts a small tmpfs)

A trial is right when the second call ends with the bytes of an undisturbed call. It is right, too, if a message names a remedy that works.
Nothing half-written may bear the name of an output. OUTPUT/kill.csv, stop.csv or disk.csv has a line per trial. ALIGNGS names the program
(default build/aligngs). docs/reliability.md has the results."""
import argparse
import csv
import random
import select
import signal
import subprocess
import sys
import time
from pathlib import Path

from commands import COMMANDS, call, fresh, prepare, start, state, temporary_files

STOPPED, STOPPED_AT_ONCE, RESOURCES = 75, 130, 5  # exit statuses
HEARD_SECONDS, ENDED_SECONDS = 0.5, 3  # a signal is answered "at once", and obeyed within three seconds
SIGNALS = [(signal.SIGINT, "Ctrl-C"), (signal.SIGTERM, "SIGTERM"), (signal.SIGHUP, "SIGHUP"), (signal.SIGINT, "Ctrl-C twice")]


def undisturbed(output, prepared, command):
    """Outputs before and after, and seconds, of a call that nothing disturbs; calls twice, for what does not repeat itself cannot be
    compared."""
    folder, states, seconds, before = output / "work", [], 0, None
    for _ in range(2):
        fresh(prepared, folder)
        before = state(folder, command)
        begin = time.time()
        status, message = call(folder, command.arguments)
        seconds = time.time() - begin
        if status:
            sys.exit(f"{command.name}: {message}")
        states.append(state(folder, command))
    differing = [f"{o}/{f}" for o in states[0] for f in states[0][o] if states[1][o].get(f) != states[0][o][f]]
    if differing:
        sys.exit(f"{command.name}: two calls differ in {differing[:5]}")
    return before, states[0], seconds


def strange_files(folder, command, before, wanted):
    """Files of the outputs that are neither as before the call nor as after it: perhaps half-written. A run that grows is left out: its
    files change from stage to stage, and the second call shows whether they are right."""
    if command.again == "--resume" or command.name == "batch":
        return []
    found = state(folder, command)
    return [f"{o}/{f}" for o in found for f in found[o] if found[o][f] not in (before[o].get(f), wanted[o].get(f))]


def second_call(folder, command, wanted):
    """The outcome of the same command again: 'same bytes', 'message, same bytes', or what went wrong."""
    if command.once and state(folder, command) == wanted:
        return "done: same bytes"
    status, message = call(folder, command.arguments)
    said = ""
    if status and state(folder, command) == wanted:
        return "message, same bytes"  # the first call had done all of it
    if status:
        if not command.again or command.again not in message:
            return f"status {status}: {message.strip()[:300]}"
        said = "message, "
        other = ["batch", "retry", "made"] if command.again == "batch retry" else [*command.arguments, command.again]
        status, message = call(folder, other)
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


def catches(process, number):
    """Whether the program has begun to listen to a signal; before that the system ends it."""
    try:
        with open(f"/proc/{process.pid}/status") as file:
            return any(line.startswith("SigCgt") and int(line.split()[1], 16) >> (number - 1) & 1 for line in file)
    except OSError:
        return False


def stop_trial(folder, command, seconds, choose, number, name):
    """A signal; with "twice" a second one when the first has been answered and a person would press again."""
    process = start(folder, command.arguments)
    begin = time.time()
    while process.poll() is None and not catches(process, number):
        time.sleep(0.001)
    moment = choose.uniform(0, seconds)
    try:
        process.wait(max(0, begin + moment - time.time()))
    except subprocess.TimeoutExpired:
        pass
    if process.poll() is not None:
        return f"{name}: ended before", "", None
    sent = time.time()
    process.send_signal(number)
    heard = select.select([process.stderr], [], [], 10)[0]
    heard_after = time.time() - sent
    if "twice" in name:
        time.sleep(0.6)
        process.send_signal(number)
    try:
        message = process.communicate(timeout=60)[1]
    except subprocess.TimeoutExpired:
        process.kill()
        return f"{name} at {moment:.2f} s", "does not end within a minute", None
    ended_after, status = time.time() - sent, process.returncode
    what = f"{name} at {moment:.2f} s of {seconds:.2f}: heard {heard_after:.2f} s, ended {ended_after:.2f} s, status {status}"
    if status == 0 and "was heard" not in message:
        return what, "", None  # it had ended by itself
    if not heard or "was heard" not in message or heard_after > HEARD_SECONDS:
        return what, f"not heard at once: {message.strip()[:200]}", None
    if status not in (STOPPED, STOPPED_AT_ONCE if "twice" in name else STOPPED, 0):
        return what, f"status {status}: {message.strip()[:200]}", None
    if ended_after > ENDED_SECONDS:
        return what, f"ended after {ended_after:.2f} s", ended_after
    left = temporary_files(folder)
    return what, f"left {left[:3]}" if left else "", ended_after


def disk_trial(folder, command, choose):
    """The folder lies on a tmpfs with little room left."""
    room = int(choose.uniform(0, 0.9) * command.writes)
    used = subprocess.run(["df", "-B1", "--output=used", str(folder.parent)], capture_output=True, text=True, check=True).stdout.split()[-1]
    subprocess.run(["mount", "-o", f"remount,size={int(used) + room // 4096 * 4096 + 4096}", str(folder.parent)], check=True)
    status, message = call(folder, command.arguments)
    left = temporary_files(folder)
    subprocess.run(["mount", "-o", "remount,size=4G", str(folder.parent)], check=True)
    problem = ""
    if status and "space" not in message.lower() and "full" not in message.lower():
        problem = f"status {status} without the reason: {message.strip()[:300]}"
    elif status not in (0, RESOURCES, 1 if command.name == "batch" else RESOURCES):
        problem = f"status {status}: {message.strip()[:300]}"
    elif status and left:
        problem = f"left {left[:3]}"
    return f"{room} of {command.writes} bytes left, status {status}", problem


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kind", choices=["kill", "stop", "disk"])
    parser.add_argument("output", type=Path)
    parser.add_argument("--trials", type=int)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--commands", nargs="+", help="only these commands (their names in commands.py)")
    parser.add_argument("--size", default="160x120", help="photos of the scene")
    parser.add_argument("--views", default="8", help="photos of the scene")
    parser.add_argument("--iterations", type=int, default=100, help="of the trained run")
    arguments = parser.parse_args()
    trials = arguments.trials or (20 if arguments.kind == "disk" else 100)
    output = arguments.output.resolve()
    commands = [c for c in COMMANDS if arguments.commands is None or c.name in arguments.commands]
    prepared = prepare(output, ["--size", arguments.size, "--views", arguments.views, "--test-views", "2"], arguments.iterations)
    choose = random.Random(arguments.seed)
    if not (prepared / "models").exists():
        commands = [c for c in commands if not c.needs_weights]
    known, slowest = {}, {}
    small = output / "small"
    if arguments.kind == "disk":
        small.mkdir(exist_ok=True)
        subprocess.run(["mount", "-t", "tmpfs", "-o", "size=4G", "tmpfs", str(small)], check=True)
    bad = 0
    try:
        with open(output / f"{arguments.kind}.csv", "w", newline="") as file:
            table = csv.writer(file)
            table.writerow(["trial", "command", "moment", "outcome"])
            for trial in range(trials):
                command = commands[trial % len(commands)]
                if command.name not in known:
                    known[command.name] = undisturbed(output, prepared, command)
                    command.writes = sum(p.stat().st_size for o in command.outputs for p in [output / "work" / o, *(output / "work" / o).rglob("*")] if p.is_file())
                before, wanted, seconds = known[command.name]
                folder = small / "work" if arguments.kind == "disk" else output / "work"
                fresh(prepared, folder)
                if arguments.kind == "disk":
                    moment, problem = disk_trial(folder, command, choose)
                elif arguments.kind == "kill":
                    moment, problem = kill_trial(folder, command, seconds, choose)
                else:
                    number, name = SIGNALS[(trial // len(commands) + trial) % len(SIGNALS)]
                    moment, problem, ended = stop_trial(folder, command, seconds, choose, number, name)
                    slowest[command.name] = max(slowest.get(command.name, 0), ended or 0)
                strange = strange_files(folder, command, before, wanted)
                if strange and not problem:
                    problem = f"neither old nor new: {strange[:4]}"
                outcome = problem or second_call(folder, command, wanted)
                bad += "same bytes" not in outcome
                table.writerow([trial, command.name, moment, outcome])
                file.flush()
                print(trial, "|", command.name, "|", moment, "|", outcome, flush=True)
    finally:
        if arguments.kind == "disk":
            subprocess.run(["umount", str(small)], check=False)
    for name, ended in slowest.items():
        print(f"{name}: ended within {ended:.2f} s")
    print(f"{trials} trials, {bad} wrong")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
