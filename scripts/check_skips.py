#!/usr/bin/env python3
"""Fails where a test was skipped for want of something that a machine need not lack.

Usage: scripts/check_skips.py RESULTS.xml     RESULTS.xml: of ctest --output-junit
A reason is allowed if a line of tests/allowed_skips.txt (a regular expression) is found in it.
"""
import pathlib
import re
import sys
import xml.etree.ElementTree as ElementTree

ALLOWED = pathlib.Path(__file__).resolve().parent.parent / "tests" / "allowed_skips.txt"


def patterns(text):
    lines = (line.strip() for line in text.splitlines())
    return [re.compile(line) for line in lines if line and not line.startswith("#")]


def reason_of(output):
    """What a test program or a script said when it skipped; the whole output where it is not found."""
    lines = output.splitlines()
    for at, line in enumerate(lines):
        if line.rstrip().endswith(": Skipped"):  # GoogleTest: the message is in the lines below
            said = []
            for below in lines[at + 1:]:
                if below.startswith("[") or not below.strip():
                    break
                said.append(below.strip())
            return " ".join(said)
        if line.startswith("skipped: "):
            return line[len("skipped: "):].strip()
    return " ".join(output.split())[:200]


def skipped_tests(results):
    """(name, reason) of every test that was skipped."""
    root = ElementTree.parse(results).getroot()
    for case in root.iter("testcase"):
        if case.find("skipped") is not None:
            yield case.get("name"), reason_of(case.findtext("system-out") or "")


def not_allowed(skipped, allowed):
    return [(name, reason) for name, reason in skipped if not any(p.search(reason) for p in allowed)]


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    skipped = list(skipped_tests(sys.argv[1]))
    wrong = not_allowed(skipped, patterns(ALLOWED.read_text(encoding="utf-8")))
    for name, reason in wrong:
        print(f"skips: {name} was skipped: {reason or 'no reason is given'}", file=sys.stderr)
    if wrong:
        print(f"skips: {len(wrong)} of {len(skipped)} have no reason in {ALLOWED.name}", file=sys.stderr)
        sys.exit(1)
    print(f"skips: ok, {len(skipped)} for reasons that a machine may have")


if __name__ == "__main__":
    main()
