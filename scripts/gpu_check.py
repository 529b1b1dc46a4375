"""Runs the parts of scripts/gpu_check.sh one by one and writes one JSON file and one table.

A part that fails, hangs or cannot start is an entry of its own and hides none of the others. The files are written
after every part, so that a run that is cut off leaves what it has.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import time

TAIL = 4000  # characters of the output of a part that did not pass


def parts_of(built, out, emulated):
    """(name, command, seconds allowed, whether its standard output is JSON), the most telling first."""
    program = str(built / "aligngs")
    if emulated:
        tests = built / "tests" / "cuda"
        return [
            ("operations", [str(tests / "cuda_emulated_op_compare")], 120, False),
            ("operations without classes", [str(tests / "cuda_emulated_op_compare"), "--channels", "0"], 120, False),
            ("networks", [str(tests / "cuda_emulated_parity")], 300, False),
            ("fusion", [str(tests / "cuda_emulated_tests"), "--gtest_brief=1", "--gtest_filter=CudaFusion.*"], 120, False),
        ]
    tests = built / "tests" / "cuda" / "device"
    bench = [program, "bench", "--device", "cuda:0", "--steps", "100", "--json"]
    large = ["--width", "640", "--height", "480", "--gaussians", "200000", "--channels", "150"]
    return [
        ("machine", [program, "doctor", "--json"], 30, True),
        ("operations", [str(tests / "cuda_gpu_op_compare")], 60, False),
        ("operations, large", [str(tests / "cuda_gpu_op_compare"), *large], 120, False),
        ("bench", bench, 60, True),
        ("bench, all pixels", [*bench, "--pixel-share", "1"], 60, True),
        ("bench, without classes", [*bench, "--channels", "0"], 60, True),
        ("bench, graphs", [*bench, "--graphs"], 60, True),
        ("bench, a lane per splat", [*bench, "--blend-backward", "splat"], 60, True),
        ("bench, compacted blocks", [*bench, "--semantic-visit", "compacted"], 60, True),
        ("bench, dense tiles", [*bench, "--semantic-visit", "dense"], 60, True),
        ("networks", [str(tests / "cuda_gpu_parity")], 120, False),
        ("whole schedule", [program, "demo", "--device", "cuda:0", "-q", "--json", "--overwrite", "-o", str(out / "run")], 180, True),
        ("tests", [str(tests / "cuda_gpu_tests"), "--gtest_brief=1"], 240, False),
    ]


def text_of(output):
    return output.decode(errors="replace") if isinstance(output, bytes) else output or ""


def run_part(command, seconds, is_json):
    """Entry of a part: state, seconds, and its JSON or the end of its output."""
    begun = time.monotonic()
    entry = {"command": " ".join(command)}
    try:
        done = subprocess.run(command, capture_output=True, timeout=seconds)
        out, err = text_of(done.stdout), text_of(done.stderr)
        entry["status"] = done.returncode
        # 77: the program says that there is no device.
        entry["state"] = "passed" if done.returncode == 0 else "skipped" if done.returncode == 77 else "failed"
        if is_json and done.returncode == 0:
            entry["result"] = json.loads(out)
        else:
            entry["output"] = (err + out)[-TAIL:]
    except subprocess.TimeoutExpired as error:
        entry.update(state="timeout", output=(text_of(error.stdout) + text_of(error.stderr))[-TAIL:])
    except json.JSONDecodeError as error:
        entry.update(state="failed", output=f"its output is no JSON: {error}")
    except OSError as error:
        entry.update(state="missing", output=str(error))
    entry["seconds"] = round(time.monotonic() - begun, 2)
    return entry


def device_line():
    try:
        return subprocess.run(["nvidia-smi", "--query-gpu=name,memory.total,driver_version", "--format=csv,noheader"],
                              capture_output=True, text=True, timeout=30, check=True).stdout.strip()
    except (OSError, subprocess.SubprocessError):
        return "no answer of nvidia-smi"


def remark(entry):
    """The figure that belongs into the table."""
    result = entry.get("result")
    if isinstance(result, dict):
        if "seconds" in result.get("step", {}):
            return f"{1000 * result['step']['seconds']:.2f} ms a step"
        if "nvs" in result:
            return f"PSNR {result['nvs']['psnr']:.2f} dB, F {result['geometry']['fscore']:.3f}"
        return ""
    lines = [line for line in entry.get("output", "").splitlines() if line.strip()]
    return lines[-1][:100].replace("|", "/") if lines else ""


def table(report):
    lines = ["# Check of a CUDA device", "", f"Device: {report['device']}", "",
             "| part | state | seconds | result |", "|---|---|---|---|"]
    for name, entry in report["parts"].items():
        lines.append(f"| {name} | {entry['state']} | {entry.get('seconds', '')} | {remark(entry)} |")
    return "\n".join(lines) + "\n"


def write(out, report):
    for name, text in (("gpu_check.json", json.dumps(report, indent=1) + "\n"), ("gpu_check.md", table(report))):
        temporary = out / (name + ".tmp")
        temporary.write_text(text)
        os.replace(temporary, out / name)


def main():
    parser = argparse.ArgumentParser(prog="gpu_check.sh")
    parser.add_argument("--built", type=pathlib.Path, required=True)
    parser.add_argument("--emulated", action="store_true")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("gpu_check"))
    parser.add_argument("--minutes", type=float, default=9)
    parser.add_argument("--only", action="append", metavar="PART", help="run this part alone; repeatable")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    end = time.monotonic() + 60 * arguments.minutes
    report = {"device": "emulated" if arguments.emulated else device_line(), "parts": {}}
    for name, command, seconds, is_json in parts_of(arguments.built.resolve(), arguments.out.resolve(), arguments.emulated):
        if arguments.only and name not in arguments.only:
            continue
        left = end - time.monotonic()
        if left < 5:
            report["parts"][name] = {"state": "no time left", "command": " ".join(command)}
        else:
            report["parts"][name] = run_part(command, min(seconds, left), is_json)
        entry = report["parts"][name]
        print(f"{entry['state']:12} {entry.get('seconds', 0):7.1f} s  {name}  {remark(entry)}", flush=True)
        write(arguments.out, report)
    if not report["parts"]:
        sys.exit(f"gpu_check.sh: no part is named {' or '.join(arguments.only)}")
    write(arguments.out, report)
    print(f"look at {arguments.out / 'gpu_check.md'}; send {arguments.out / 'gpu_check.json'} with a report")
    return 0 if all(entry["state"] == "passed" for entry in report["parts"].values()) else 1


if __name__ == "__main__":
    sys.exit(main())
