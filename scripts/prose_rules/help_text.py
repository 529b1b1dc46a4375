"""Prose of help texts: the string literals of options, commands and footers in C++ sources."""
import re

from prose_rules.markdown import plain
from prose_rules.sentence import Measured, check_sentence, sentences_of

HELP_CALL = re.compile(r"(?:add_option|add_flag|add_flag_function|add_option_function|add_choice_option|add_subcommand|help_footer|description)\s*\(|"
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
