#!/usr/bin/env python3
"""Measures prose by the rules of CONTRIBUTING.md.

    scripts/prose.py                  checks README, docs, help texts and comments; status 1 when a file breaks a rule
    scripts/prose.py --table [FILE..] prints words, sentences, mean length and numbers of each page and of the
                                      sources of each folder

Markdown is read without code blocks and HTML comments; tables and headings count for private words alone. Help texts are
the string literals of options, commands and footers in src/cli. Comments are those of C++, CUDA, TypeScript and JavaScript;
prose_rules/comment.py says how they are read. scripts/prose_allowed.txt lists files that still break rules and how often,
or "any" for a page that is being rewritten. A file may not get worse."""
import sys
from itertools import groupby
from pathlib import Path

from prose_rules import comment, help_text, markdown
from prose_rules.sentence import Measured

ROOT = Path(__file__).resolve().parent.parent
ALLOWED = ROOT / "scripts" / "prose_allowed.txt"
SOURCE_FOLDERS = ["src", "tests", "benchmarks", "web/src", "web/test"]


def joined(parts):
    return Measured([s for part in parts for s in part.sentences], [f for part in parts for f in part.findings])


def has_help(path):
    return path.suffix == ".cpp" and path.is_relative_to(ROOT / "src/cli") and not path.name.endswith("_test.cpp")


def measure(path):
    text = path.read_text(encoding="utf-8")
    if path.suffix not in comment.SUFFIXES:
        return markdown.measure_markdown(text)
    parts = [comment.measure_comments(text, path.suffix)]
    if has_help(path):
        parts.append(help_text.measure_help(text))
    return joined(parts)


def pages():
    return sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), ROOT / "benchmarks/README.md"])


def sources():
    """Hand-written sources; the built page lies in another folder, and packages are left out. Needs no git."""
    files = [file for folder in SOURCE_FOLDERS for file in (ROOT / folder).rglob("*")
             if file.suffix in comment.SUFFIXES and "node_modules" not in file.parts]
    return sorted(files + list(ROOT.glob("web/*.mjs")))


def allowed_counts():
    counts = {}
    for line in ALLOWED.read_text(encoding="utf-8").splitlines():
        if line and not line.startswith("#"):
            name, count = line.rsplit(None, 1)
            counts[name] = sys.maxsize if count == "any" else int(count)
    return counts


def name_of(path):
    return str(path.relative_to(ROOT)) if path.is_relative_to(ROOT) else str(path)


def folder_of(path):
    return "/".join(path.relative_to(ROOT).parent.parts[:2]) + "/"


def print_table(rows):
    """One row for each (name, files)."""
    print("| file | words | of these prose | sentences | words per sentence | numbers per sentence | findings |")
    print("|---|---|---|---|---|---|---|")
    for name, files in rows:
        m = joined([measure(path) for path in files])
        if m.sentences:
            every = len(files[0].read_text(encoding="utf-8").split()) if files[0].suffix == ".md" else m.words()
            print(f"| {name} | {every} | {m.words()} | {len(m.sentences)} | {m.words() / len(m.sentences):.1f} | "
                  f"{m.numbers() / len(m.sentences):.2f} | {len(m.findings)} |")


def check(files):
    allowed, failed = allowed_counts(), False
    for path in files:
        name, findings = name_of(path), measure(path).findings
        if len(findings) > allowed.get(name, 0):
            failed = True
            for finding in findings:
                print(f"prose: {name}:{finding.line}: {finding.rule}: {finding.text[:160]}", file=sys.stderr)
            print(f"prose: {name}: {len(findings)} findings, {allowed.get(name, 0)} allowed", file=sys.stderr)
        elif len(findings) < allowed.get(name, 0) < sys.maxsize:
            print(f"prose: {name}: {len(findings)} findings, {allowed[name]} allowed: lower the number in {name_of(ALLOWED)}")
    if not failed:
        print("prose: ok")
    return 1 if failed else 0


def main(arguments):
    named = [Path(name).resolve() for name in arguments if not name.startswith("--")]
    if "--table" not in arguments:
        return check(named or pages() + sources())
    rows = [(name_of(path), [path]) for path in named or pages()]
    if not named:
        rows += [(folder, list(files)) for folder, files in groupby(sorted(sources(), key=folder_of), folder_of)]
    print_table(rows)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
