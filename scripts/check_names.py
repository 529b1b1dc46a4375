#!/usr/bin/env python3
"""Names of one file that another file of the same module has in its anonymous namespace, too.

    scripts/check_names.py

Builds that compile several sources of a module at once (ALIGNGS_UNITY_BUILD) fail where two such sources meet. Which
sources meet changes with every new file. Prints each name with its files and exits with status 1; prints "names: ok"
without any."""
import collections
import re
import sys
from pathlib import Path

SOURCES = Path(__file__).resolve().parents[1] / "src"
TYPE = re.compile(r"(?:template <[^>]*>\s*)?(?:struct|class|enum class|enum) (?:alignas\(\w+\) )?(\w+)(?! *;)")
CONSTANT = re.compile(r"(?:inline |static |constexpr |const )+[\w:<>, *&]+?[ &*](k[A-Z]\w*)\b")
FUNCTION = re.compile(r"[\w:<>,&* ]+[ &*](\w+)\((.*)")


def hidden_names(text):
    """Names at the start of lines of the anonymous namespaces: (name, kinds of arguments of a function)."""
    for block in re.findall(r"\nnamespace \{\n(.*?)\n\}  // namespace\n", text, re.S):
        for line in block.split("\n"):
            if line.startswith((" ", "#", "/", "}", "using", "friend", "extern")):
                continue
            found = TYPE.match(line) or CONSTANT.match(line)
            if found:
                yield found.group(1), ""
                continue
            found = FUNCTION.match(line)
            if found:  # functions with other arguments are overloads
                yield found.group(1), re.sub(r" \w+([,)])", r"\1", found.group(2))


def main():
    findings = 0
    for module in sorted(p for p in SOURCES.iterdir() if p.is_dir()):
        files = collections.defaultdict(set)
        for source in sorted(module.rglob("*.cpp")):
            if source.name.endswith("_test.cpp") or "cuda" in source.relative_to(SOURCES).parts:
                continue
            for name in hidden_names(source.read_text(encoding="utf-8")):
                files[name].add(str(source.relative_to(SOURCES.parent)))
        for (name, _), where in sorted(files.items()):
            if len(where) > 1:
                findings += 1
                print(f"names: {name} is in {', '.join(sorted(where))}")
    print("names: ok" if findings == 0 else f"names: {findings} findings; give each its own name")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
