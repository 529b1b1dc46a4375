#!/usr/bin/env python3
"""Names of one file that another file of the same module has in its anonymous namespace, too, and constants there that
have the name of a header's constant. Tests of a module meet each other alone, and so do those of the folder tests.
Also types that two files define outside of anonymous namespaces: one struct, class or enum per name in all of src.

    scripts/check_names.py

Builds that compile several sources of a module at once (ALIGNGS_UNITY_BUILD) fail where two such sources meet. Which
sources meet changes with every new file. Prints each name with its files and exits with status 1; prints "names: ok"
without any."""
import collections
import re
import sys
from pathlib import Path

SOURCES = Path(__file__).resolve().parents[1] / "src"
TEST = "_test.cpp"
TYPE = re.compile(r"(?:template <[^>]*>\s*)?(?:struct|class|enum class|enum) (?:alignas\(\w+\) )?(\w+)(?! *;)")
DEFINED_TYPE = re.compile(TYPE.pattern.removesuffix("(?! *;)") + r"(?: final)?(?: : .*)? ?\{")
CONSTANT = re.compile(r"(?:inline |static |constexpr |const )+[\w:<>, *&]+?[ &*](k[A-Z]\w*)\s*[={\[(;]")
HIDDEN = re.compile(r"\nnamespace \{\n(.*?)\n\}  // namespace\n", re.S)
ALIAS = re.compile(r"using (\w+) = (.*)")
FUNCTION = re.compile(r"[\w:<>,&* ]+[ &*](\w+)\((.*)")


def hidden_names(text):
    """Names at the start of lines of the anonymous namespaces: (name, arguments of a function, meaning of an alias)."""
    for block in HIDDEN.findall(text):
        for line in block.split("\n"):
            if line.startswith((" ", "#", "/", "}", "using namespace", "using ::", "friend", "extern")):
                continue
            found = ALIAS.match(line)
            if found:
                yield found.group(1), "", found.group(2)
                continue
            found = TYPE.match(line) or CONSTANT.match(line)
            if found:
                yield found.group(1), "", ""
                continue
            found = FUNCTION.match(line)
            if found:  # functions with other arguments are overloads
                arguments = found.group(2).replace("std::filesystem::", "fs::").split(") ")[0] + ")"
                yield found.group(1), re.sub(r" \w+([,)])", r"\1", arguments), ""


def namespace_of(text):
    found = re.search(r"^namespace ([\w:]+) \{", text, re.M)
    return found.group(1) if found else ""


def constants_of_headers(sources):
    """The header of each constant that any source may include: {(namespace, name): header}."""
    headers = {}
    for header in sorted(sources.rglob("*.h")):
        if "testing" in header.parts or header.name.endswith("-inl.h"):
            continue
        text = header.read_text(encoding="utf-8")
        for line in text.split("\n"):
            found = CONSTANT.match(line)
            if found and not line.startswith(" "):
                headers[namespace_of(text), found.group(1)] = str(header.relative_to(sources.parent))
    return headers


def shared_types(sources):
    """Files that define each type outside of anonymous namespaces and of other types: {name: files}."""
    files = collections.defaultdict(set)
    for source in sorted(f for f in sources.rglob("*") if f.suffix in (".h", ".cuh", ".cpp", ".cu")):
        text = HIDDEN.sub("\n", source.read_text(encoding="utf-8"))
        for line in text.split("\n"):
            found = DEFINED_TYPE.match(line)
            if found:
                files[found.group(1)].add(str(source.relative_to(sources.parent)))
    return files


def groups(sources):
    """Files of each program or library that a unity build compiles together."""
    for module in sorted(p for p in sources.iterdir() if p.is_dir()):
        files = [f for f in sorted(module.rglob("*.cpp")) if "cuda" not in f.relative_to(sources).parts]
        yield [f for f in files if not f.name.endswith(TEST)]
        yield [f for f in files if f.name.endswith(TEST)]
    yield sorted((sources.parent / "tests").glob("*" + TEST))


def clashes(sources):
    """Each name that cannot be compiled at once, with its files."""
    headers = constants_of_headers(sources)
    for group in groups(sources):
        files = collections.defaultdict(set)
        for source in group:
            text = source.read_text(encoding="utf-8")
            for name, arguments, meaning in hidden_names(text):
                files[name, arguments].add((str(source.relative_to(sources.parent)), meaning))
                if (namespace_of(text), name) in headers:
                    files[name, arguments].add((headers[namespace_of(text), name], ""))
        for (name, _), places in sorted(files.items()):
            where, meanings = {file for file, _ in places}, {meaning for _, meaning in places}
            if len(where) > 1 and (len(meanings) > 1 or meanings == {""}):  # the same alias may come again
                yield name, sorted(where)
    for name, where in sorted(shared_types(sources).items()):
        if len(where) > 1:
            yield name, sorted(where)


def main():
    findings = list(clashes(SOURCES))
    for name, where in findings:
        print(f"names: {name} is in {', '.join(where)}")
    print(f"names: {len(findings)} findings; give each its own name" if findings else "names: ok")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
