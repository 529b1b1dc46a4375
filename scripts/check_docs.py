#!/usr/bin/env python3
"""Checks that the documentation names things that exist: links, files, commands, options and settings.

    scripts/check_docs.py [FILE...]      status 1 when something is missing

Commands and options are compared with the sources of the command line, so that nothing has to be built."""
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
MODULE_FILE = re.compile(r"(core|io|scene|nn|priors|synth|refine|room|gaussians|engine|metrics|train|mesh|edit|serve|batch|cli)/[\w/*]+\.(h|cpp|cuh?)")
TOP_FOLDERS = ("src/", "docs/", "scripts/", "tests/", "benchmarks/", "web/", "cmake/")
NOT_IN_THE_TREE = ("web/dist/", "build/", "tests/node/node_modules")


def tracked_files():
    """Files that git knows or would add; all files where there is no git, as in an archive."""
    if not (ROOT / ".git").exists():
        return [str(file.relative_to(ROOT)) for file in ROOT.rglob("*") if file.is_file()]
    listed = subprocess.run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=ROOT, capture_output=True,
                            text=True, check=True)
    return [name for name in listed.stdout.split("\0") if name and (ROOT / name).exists()]


def anchors_of(markdown):
    """The anchors that GitHub gives to headings."""
    titles = re.findall(r"^#+\s+(.*)$", re.sub(r"```.*?```", "", markdown, flags=re.S), flags=re.M)
    return {re.sub(r"[^\w\- ]", "", re.sub(r"[`*]", "", title)).strip().lower().replace(" ", "-") for title in titles}


def link_problems(path, markdown):
    text = re.sub(r"```.*?```|`[^`\n]*`", "", markdown, flags=re.S)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if re.match(r"\w+://|mailto:", target):
            continue
        name, _, anchor = target.partition("#")
        file = (path.parent / name).resolve() if name else path
        if not file.exists():
            yield f"the link {target} leads nowhere"
        elif anchor and file.suffix == ".md" and anchor not in anchors_of(file.read_text(encoding="utf-8")):
            yield f"the link {target} names a heading that is not there"


def exists_in_tree(name, files):
    """A path, a folder, a source without its ending, a pattern with an asterisk, or a path below src/."""
    for place in (name, "src/" + name, "benchmarks/quality/" + name, "benchmarks/" + name, "tests/" + name):
        pattern = re.escape(place.rstrip("/")).replace(r"\*", "[^/]*")
        if any(re.match(pattern + r"(\.\w+|/.*)?$", file) for file in files):
            return True
    return False


def path_problems(markdown, files):
    for code in re.findall(r"`([^`\n]+)`", markdown):
        for word in code.split():
            word = word.strip(",;:()")
            named = word.startswith(TOP_FOLDERS) and not word.startswith(NOT_IN_THE_TREE) and re.fullmatch(r"[\w./*\-]+", word)
            if (named or MODULE_FILE.fullmatch(word)) and "NNNN" not in word:
                if not exists_in_tree(word, files):
                    yield f"there is no file {word}"


def command_line():
    """{command: options}; options of every command under ""; nested commands as "data check"."""
    sources = {file.name: file.read_text(encoding="utf-8") for file in sorted((ROOT / "src/cli").glob("*.cpp"))}
    names = set(re.findall(r'add_subcommand\(\s*"([\w-]+)"', " ".join(sources.values())))
    options = set()
    for text in sources.values():
        for spelled in re.findall(r'(?:add_option|add_flag|add_flag_function|add_choice_option|set_version_flag)\((?:\s*\*?command,)?\s*"([^"]+)"', text):
            options.update(part.strip() for part in spelled.split(",") if part.startswith("-"))
    return names, options | {"--help", "-h", "--version"}


def command_problems(markdown, names, options):
    blocks = re.findall(r"```[^\n]*\n(.*?)```", markdown, flags=re.S)
    lines = [line for block in blocks for line in block.replace("\\\n", " ").splitlines()] + re.findall(r"`([^`\n]+)`", markdown)
    for line in lines:
        for call in re.findall(r"(?:^|[\s/&;(])aligngs\s+([^|;&#`]*)", line):
            words = call.split()
            first = words[0] if words else ""
            if re.fullmatch(r"[a-z][a-z-]*", first) and first not in names:
                yield f"there is no command: aligngs {first}"
            for word in words:
                option = re.match(r"-{1,2}[A-Za-z][\w-]*", word)
                if option and option.group(0) not in options:
                    yield f"no command has the option {option.group(0)}: aligngs {call.strip()}"


def setting_keys():
    return set(re.findall(r"^\| `([a-z_]+\.[a-z_]+)` \|", (ROOT / "docs/settings.md").read_text(encoding="utf-8"), flags=re.M))


def setting_problems(markdown, keys):
    groups = {key.split(".")[0] for key in keys}
    for code in re.findall(r"`(?:--set )?([a-z_]+\.[a-z_]+)(?:=[^`]*)?`", markdown):
        if code.split(".")[0] in groups and code not in keys and not re.search(r"\.(json|png|md|ply|py|cpp|h|toml|csv|html|jpg|txt)$", code):
            yield f"there is no setting {code}"


def main(arguments):
    files = tracked_files()
    names, options = command_line()
    keys, count = setting_keys(), 0
    pages = [Path(name).resolve() for name in arguments] or [
        ROOT / name for name in files if name.endswith(".md") and not name.startswith(("tests/data", "benchmarks/quality"))]
    for page in pages:
        text = page.read_text(encoding="utf-8")
        problems = [*link_problems(page, text), *path_problems(text, files), *command_problems(text, names, options),
                    *setting_problems(text, keys)]
        for problem in dict.fromkeys(problems):
            print(f"docs: {page.relative_to(ROOT)}: {problem}", file=sys.stderr)
            count += 1
    if count == 0:
        print("docs: ok")
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
