#!/usr/bin/env python3
"""Tests of prose.py."""
import unittest

import prose


def rules(markdown):
    return [finding.rule for finding in prose.measure_markdown(markdown).findings]


class Prose(unittest.TestCase):
    def test_a_short_sentence_passes(self):
        self.assertEqual(rules("The subject comes first.\n"), [])

    def test_a_sentence_of_more_than_25_words_is_found(self):
        self.assertEqual(rules(" ".join(["a"] * 26) + ".\n"), ["26 words"])
        self.assertEqual(rules(" ".join(["a"] * 25) + ".\n"), [])

    def test_two_numbers_are_found_but_no_range_or_interval(self):
        self.assertEqual(rules("It takes 3 or 4 steps.\n"), ["2 numbers"])
        for text in ("It takes 3 to 4 steps.", "F is +0.1 [-0.1, +0.3].", "F at 5 cm is 0.9.", "There are 92 000 of them.", "It serves 127.0.0.1 on 7860."):
            self.assertEqual(rules(text + "\n"), [], text)

    def test_first_words_and_private_words_are_found(self):
        self.assertEqual(rules("Which is so.\n"), ['begins with "Which"'])
        self.assertEqual(rules("Which is so?\n"), [])
        self.assertEqual(rules("It does so unasked.\n"), ['the words "unasked"'])

    def test_tables_code_and_comments_are_no_prose(self):
        long = " ".join(["word"] * 40)
        self.assertEqual(rules(f"| {long} |\n\n```\n{long}\n```\n\n<!-- {long} -->\n"), [])

    def test_items_are_sentences_of_their_own(self):
        measured = prose.measure_markdown("- one\n- two\n\nThree. Four, et al. 5.\n")
        self.assertEqual([text for _, text in measured.sentences], ["one", "two", "Three.", "Four, et al. 5."])

    def test_inline_code_is_one_word(self):
        self.assertEqual(prose.measure_markdown("Run `aligngs demo --view` now.\n").words(), 3)

    def test_long_lines_are_found_but_no_tables(self):
        self.assertEqual(rules("x" * 121 + "\n"), ["121 columns"])
        self.assertEqual(rules("| " + "x" * 130 + " |\n"), [])

    def test_help_texts_are_read_from_options_and_commands(self):
        source = ('command->add_option("-o,--output", options.output, "file to write "\n  "(default: run)")->required();\n'
                  'log("not a help text");\ncommand->footer(help_footer({.example = "aligngs demo", .notes = "Of two words."}));')
        self.assertEqual([text for _, text in prose.help_texts(source)],
                         ["file to write (default: run)", "aligngs demo", "Of two words."])
        self.assertEqual([f.rule for f in prose.measure_help(source).findings], ['begins with "Of"'])


if __name__ == "__main__":
    unittest.main()
