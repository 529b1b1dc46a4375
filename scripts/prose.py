#!/usr/bin/env python3
"""Measures prose by the rules of CONTRIBUTING.md.

    scripts/prose.py                  checks README, docs and the help texts; status 1 when a file breaks a rule
    scripts/prose.py --table [FILE..] prints words, sentences, mean length and numbers of each file

A Markdown file is read without code blocks, tables, HTML comments and headings. Inline code counts as one word. Help texts are
the string literals of options, commands and footers in src/cli. scripts/prose_allowed.txt lists files that still break rules
and how often, or "any" for a page that is being rewritten. A file may not get worse."""
import re
import sys
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
ALLOWED = ROOT / "scripts" / "prose_allowed.txt"
MOST_WORDS = 25
MOST_NUMBERS = 1
MOST_COLUMNS = 120
FIRST_WORDS = {"What", "Of", "Where", "Which", "That"}
PRIVATE_WORDS = [
    "unasked", "by heart", "stands", "stand", "says so", "say so", "as it came", "as they came", "draws to", "drawn to", "all the same",
    "so-manieth", "hear of", "hears of", "at hand", "is told", "are told", "what it costs", "beside each other", "in return",
]
PRIVATE = re.compile(r"\b(" + "|".join(PRIVATE_WORDS) + r")\b", re.IGNORECASE)
# Abbreviations do not end a sentence.
ABBREVIATION = re.compile(r"\b(et al|e\.g|i\.e|cf|vs|Fig|No|St)\.")
SENTENCE_END = re.compile(r"(?<=[.!?])[\"')*_]*\s+(?=[\"'(*_\[]*[A-Z0-9`])")
# Names that hold digits are no numbers: the threshold in "F at 5 cm", a size of pictures, a decision's number.
NAME_WITH_NUMBER = re.compile(r"\bat \d+ (and \d+ )?cm\b|\bTable \d+\b|\b\d+ ?[x×] ?\d+\b|\b0\d{3}\b")
NUMBER = re.compile(r"^[+\-−±~≤<>=(\[]*\d[\d.,:×x/%°\-–]*(k|M|B|s|ms|GB|MB|dB|cm|mm|m|px|%)?[)\].,;:!?]*$")


@dataclass
class Finding:
    line: int
    rule: str
    text: str


@dataclass
class Measured:
    sentences: list = field(default_factory=list)  # (line, text)
    findings: list = field(default_factory=list)

    def words(self):
        return sum(len(words_of(text)) for _, text in self.sentences)

    def numbers(self):
        return sum(numbers_of(text) for _, text in self.sentences)


def one_figure(text):
    """A range, an interval and groups of three digits are one number each."""
    text = re.sub(r"(?<=\d)[ \u202f](?=\d{3}\b)", "", text)
    text = re.sub(r"(?<=[\d%A-Za-z]) \[[+\-−]?\d[^\]]*\]", "", text)
    return re.sub(r"([+\-−]?\d[\d.,]*) to ([+\-−]?\d[\d.,]*)", r"\1-\2", NAME_WITH_NUMBER.sub("at-threshold", text))


def words_of(text):
    return [word for word in text.split() if re.search(r"\w", word)]


def numbers_of(text):
    return sum(bool(NUMBER.match(word)) and word.count(".") < 3 for word in one_figure(text).split())


def sentences_of(text):
    text = ABBREVIATION.sub(lambda m: m.group(0).replace(".", "\u2024"), text)
    return [part.strip().replace("\u2024", ".") for part in SENTENCE_END.split(text) if part and re.search(r"\w", part)]


def plain(text):
    """Markdown without its marks; inline code is one word, a link is its text, a picture its alt text."""
    text = re.sub(r"!\[([^\]]*)\]\([^)]*\)", r"\1", text)
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)
    text = re.sub(r"`[^`]*`", "CODE", text)
    text = re.sub(r"https?://\S+", "LINK", text)
    return re.sub(r"\*\*|(?<!\w)[*_]|[*_](?!\w)", "", text)


def paragraphs_of(markdown):
    """(line, text) of every paragraph and list item; and the lines that are prose."""
    paragraphs, prose_lines, current, start, fenced, comment = [], [], [], 0, False, False

    def close():
        if current:
            paragraphs.append((start, " ".join(current)))
            current.clear()

    for number, line in enumerate(markdown.splitlines(), 1):
        stripped = line.strip()
        if stripped.startswith("```"):
            fenced = not fenced
            close()
            continue
        if fenced:
            continue
        if comment or stripped.startswith("<!--"):
            comment = "-->" not in stripped
            close()
            continue
        if stripped.startswith("|"):
            close()
            continue
        prose_lines.append((number, line))
        if not stripped or stripped.startswith("#"):
            close()
            continue
        item = re.match(r"(?:[-*+]|\d+\.)\s+(.*)", stripped)
        if item or stripped.startswith(">"):
            close()
            stripped = item.group(1) if item else stripped.lstrip("> ")
        if not current:
            start = number
        current.append(stripped)
    close()
    return paragraphs, prose_lines


def check_sentence(line, text):
    findings = []
    words = words_of(text)
    if len(words) > MOST_WORDS:
        findings.append(Finding(line, f"{len(words)} words", text))
    if numbers_of(text) > MOST_NUMBERS:
        findings.append(Finding(line, f"{numbers_of(text)} numbers", text))
    first = re.sub(r"^\W+", "", words[0]) if words else ""
    if re.sub(r"\W+$", "", first) in FIRST_WORDS and not text.rstrip().endswith("?"):
        findings.append(Finding(line, f'begins with "{first}"', text))
    for match in PRIVATE.finditer(text):
        findings.append(Finding(line, f'the words "{match.group(0)}"', text))
    return findings


def measure_markdown(markdown):
    measured = Measured()
    paragraphs, prose_lines = paragraphs_of(markdown)
    for line, text in prose_lines:
        if len(text) > MOST_COLUMNS and not re.match(r"\s*!?\[", text):
            measured.findings.append(Finding(line, f"{len(text)} columns", text))
    for line, paragraph in paragraphs:
        for sentence in sentences_of(plain(paragraph)):
            measured.sentences.append((line, sentence))
            measured.findings += check_sentence(line, sentence)
    return measured


HELP_CALL = re.compile(r"(?:add_option|add_flag|add_flag_function|add_option_function|add_subcommand|help_footer|description)\s*\(|"
                       r"std::string what =|CLI::App program\(")
LITERAL = re.compile(r'"((?:[^"\\]|\\.)*)"')


def call_text(source, start):
    """The arguments of a call whose bracket opens before `start`; brackets in literals do not count."""
    depth, i = 1, start
    while i < len(source) and depth > 0:
        if source[i] == '"':
            i = LITERAL.match(source, i).end()
            continue
        depth += {"(": 1, ")": -1}.get(source[i], 0)
        if source[i] == ";":
            break
        i += 1
    return source[start:i]


def help_texts(source):
    """(line, text) of every help text: neighbouring literals are one."""
    texts = []
    for call in HELP_CALL.finditer(source):
        arguments = call_text(source, call.end())
        line = source.count("\n", 0, call.start()) + 1
        for chunk in re.finditer(r'"(?:[^"\\]|\\.)*"(?:\s*"(?:[^"\\]|\\.)*")*', arguments):
            text = "".join(LITERAL.findall(chunk.group(0))).replace('\\"', '"')
            if " " in text:
                texts.append((line, text.replace("\\n", "\n")))
    return texts


def measure_help(source):
    measured = Measured()
    for line, text in help_texts(source):
        for part in text.splitlines():
            if not part.strip() or re.match(r"\s*(Examples?:|aligngs |#)", part) or part.startswith("  "):
                continue
            for sentence in sentences_of(plain(part)):
                measured.sentences.append((line, sentence))
                measured.findings += check_sentence(line, sentence)
    return measured


def measure(path):
    text = path.read_text(encoding="utf-8")
    return measure_help(text) if path.suffix == ".cpp" else measure_markdown(text)


def checked_files():
    """README, documentation and the sources of help texts; without git, as in an archive, too."""
    pages = [*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), ROOT / "benchmarks/README.md"]
    sources = [file for file in ROOT.glob("src/cli/*.cpp") if not file.name.endswith("_test.cpp")]
    return sorted(pages) + sorted(sources)


def allowed_counts():
    counts = {}
    for line in ALLOWED.read_text(encoding="utf-8").splitlines():
        if line and not line.startswith("#"):
            name, count = line.rsplit(None, 1)
            counts[name] = sys.maxsize if count == "any" else int(count)
    return counts


def name_of(path):
    return str(path.relative_to(ROOT)) if path.is_relative_to(ROOT) else str(path)


def print_table(files):
    print("| file | words | of these prose | sentences | words per sentence | numbers per sentence | findings |")
    print("|---|---|---|---|---|---|---|")
    for path in files:
        m = measure(path)
        if m.sentences:
            every = len(path.read_text(encoding="utf-8").split()) if path.suffix == ".md" else m.words()
            print(f"| {name_of(path)} | {every} | {m.words()} | {len(m.sentences)} | {m.words() / len(m.sentences):.1f} | "
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
    table = "--table" in arguments
    files = [Path(name).resolve() for name in arguments if not name.startswith("--")] or checked_files()
    if table:
        print_table(files)
        return 0
    return check(files)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
