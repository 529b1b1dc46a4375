"""Prose of the comments of C++, CUDA, TypeScript and JavaScript sources.

Numbers and line lengths are not measured: comments give formulas and tolerances, and formatters keep their lines. Code in
backquotes, a formula, a call and a text in square brackets are one word each."""
import re

from prose_rules.sentence import ABBREVIATION, Measured, check_sentence

SUFFIXES = {".h", ".cpp", ".cu", ".cuh", ".ts", ".js", ".mjs"}
SCRIPTS = {".ts", ".js", ".mjs"}
# Literals come before comments, so that "//" in one of them begins no comment; 1'000 opens no character.
CPP_TOKEN = re.compile(r'(?P<raw>R"(?P<mark>\w*)\(.*?\)(?P=mark)")|\b\d[\w\'.]*|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'|'
                       r"(?P<comment>//[^\n]*|/\*.*?\*/)", re.DOTALL)
# A "/" opens a regular expression where an operand is due.
SCRIPT_TOKEN = re.compile(r'"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'|`(?:\\.|[^`\\])*`|(?P<comment>//[^\n]*|/\*.*?\*/)|'
                          r"(?<=[(,=:\[!&|?{};\s])/(?:\\.|\[(?:\\.|[^\]\\\n])*\]|[^/\\\n\[ ])(?:\\.|\[(?:\\.|[^\]\\\n])*\]|[^/\\\n\[])*/[a-z]*",
                          re.DOTALL)
ITEM = re.compile(r"(?:[-*•]|\d+\.|\(?[a-z]\))\s+(.*)")
USAGE = re.compile(r"Usage:|clang-format o|NOLINT")
# Columns of a table or of a list of commands, and a frame drawn with characters.
COLUMNS = re.compile(r"\S {3,}\S|^[-=~*/\s|+]*$")
CODE = re.compile(r"`[^`]*`|https?://\S+")
CALL = re.compile(r"[\w:.>\-]*\w\([^()]*\)")
BRACKETS = re.compile(r"[\w\]})]*\[[^\[\]()]*[\])](?:\[[^\[\]]*\])*")
OPERATOR = r"(?:[=+\-−*/·×^<>≤≥≈∈|]|[<>=!+\-*/]=|->|<<|>>|&&|\|\|)"
FORMULA = re.compile(rf"\S+(?:\s+{OPERATOR}\s+\S+)+")
# A sentence may begin with a name in lower case; " . " is a product and "..." an omission.
END = re.compile(r"(?<=[^\s.][.!?])[\"')]*\s+")


def comments_of(source, suffix):
    """(line, column, text) of every line of every comment; text has no marks but keeps the blanks before it."""
    lines = []
    for token in (SCRIPT_TOKEN if suffix in SCRIPTS else CPP_TOKEN).finditer(source):
        comment = token.group("comment")
        if comment is None:
            continue
        line = source.count("\n", 0, token.start()) + 1
        column = token.start() - source.rfind("\n", 0, token.start()) - 1
        first = not source[token.start() - column:token.start()].strip()
        if comment.startswith("//"):
            lines.append((line, column, first, re.sub(r"^//+[!<]*", "", comment)))
            continue
        for offset, text in enumerate(comment[2:-2].splitlines()):
            lines.append((line + offset, column, first or offset > 0, re.sub(r"^\s*\*+<?", "", text)))
    return lines


def paragraphs_of(source, suffix):
    """(line, text) of every paragraph and item. Comments of one column in consecutive lines are one."""
    paragraphs, current = [], []
    start, last, item_depth = 0, None, None

    def close():
        if current:
            paragraphs.append((start, " ".join(current)))
            current.clear()

    for line, column, first, raw in comments_of(source, suffix):
        if not first or last != (line - 1, column):
            close()
            item_depth = None
        last = (line, column)
        text, depth = raw.strip(), len(raw) - len(raw.lstrip())
        if not text or COLUMNS.search(text) or USAGE.match(text):
            close()
            item_depth = None
            continue
        item = ITEM.match(text)
        if item or (item_depth is None or depth <= item_depth) and depth > 2:
            close()
            item_depth = depth
        elif item_depth is not None and depth <= item_depth:
            close()
            item_depth = None
        if not current:
            start = line
        current.append(item.group(1) if item else text)
    close()
    return paragraphs


def plain(text):
    """Code, calls, bracketed texts and formulas become one word each."""
    text = CODE.sub("CODE", text)
    text = BRACKETS.sub("BRACKETS", CALL.sub("CALL", text))
    return FORMULA.sub(lambda m: "FORMULA" + re.search(r"[.!?,;:]*$", m.group(0)).group(0), text)


def sentences_of(text):
    text = ABBREVIATION.sub(lambda m: m.group(0).replace(".", "\u2024"), text)
    return [part.strip().replace("\u2024", ".") for part in END.split(text) if re.search(r"\w", part)]


def measure_comments(source, suffix):
    measured = Measured()
    for line, paragraph in paragraphs_of(source, suffix):
        for sentence in sentences_of(plain(paragraph)):
            measured.sentences.append((line, sentence))
            measured.findings += [f for f in check_sentence(line, sentence) if not f.rule.endswith("numbers")]
    return measured
