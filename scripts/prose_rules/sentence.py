"""The rules of CONTRIBUTING.md for one sentence, and how a text is split into sentences and words."""
import re
from dataclasses import dataclass, field

MOST_WORDS = 25
MOST_NUMBERS = 1
FIRST_WORDS = {"What", "Of", "Where", "Which", "That"}
PRIVATE_WORDS = [
    "unasked", "by heart", "stands", "stand", "stood", "says so", "say so", "as it came", "as they came", "draws to",
    "drawn to", "all the same",
    "so-manieth", "hear of", "hears of", "at hand", "is told", "are told", "what it costs", "beside each other", "in return",
    "told apart", "tell apart", "tells apart", "mended", "mends", "strangers",
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


def private_words(line, text):
    return [Finding(line, f'the words "{match.group(0)}"', text) for match in PRIVATE.finditer(text)]


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
    return findings + private_words(line, text)
