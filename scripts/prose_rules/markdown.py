"""Prose of a Markdown page, without code blocks and HTML comments. Tables and headings may hold no private words either."""
import re

from prose_rules.sentence import Finding, Measured, check_sentence, private_words, sentences_of

MOST_COLUMNS = 120


def plain(text):
    """Markdown without its marks; inline code is one word, a link is its text, a picture its alt text."""
    text = re.sub(r"!\[([^\]]*)\]\([^)]*\)", r"\1", text)
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)
    text = re.sub(r"`[^`]*`", "CODE", text)
    text = re.sub(r"https?://\S+", "LINK", text)
    return re.sub(r"\*\*|(?<!\w)[*_]|[*_](?!\w)", "", text)


def paragraphs_of(markdown):
    """(line, text) of every paragraph and list item; of the lines that are prose; and of the rows of tables and headings."""
    paragraphs, prose_lines, labels, current, start, fenced, comment = [], [], [], [], 0, False, False

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
        if stripped.startswith(("|", "#")):
            labels.append((number, stripped))
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
    return paragraphs, prose_lines, labels


def measure_markdown(markdown):
    measured = Measured()
    paragraphs, prose_lines, labels = paragraphs_of(markdown)
    for line, text in labels:
        measured.findings += private_words(line, plain(text))
    for line, text in prose_lines:
        if len(text) > MOST_COLUMNS and not re.match(r"\s*!?\[", text):
            measured.findings.append(Finding(line, f"{len(text)} columns", text))
    for line, paragraph in paragraphs:
        for sentence in sentences_of(plain(paragraph)):
            measured.sentences.append((line, sentence))
            measured.findings += check_sentence(line, sentence)
    return measured
