#!/usr/bin/env python3
"""Tests of prose_rules."""
import unittest

from prose_rules import comment, help_text, markdown


def rules(page):
    return [finding.rule for finding in markdown.measure_markdown(page).findings]


class Pages(unittest.TestCase):
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

    def test_tables_and_headings_hold_no_private_words(self):
        self.assertEqual(rules("| it does so unasked | `stands` |\n"), ['the words "unasked"'])
        self.assertEqual(rules("# By heart\n"), ['the words "By heart"'])

    def test_items_are_sentences_of_their_own(self):
        measured = markdown.measure_markdown("- one\n- two\n\nThree. Four, et al. 5.\n")
        self.assertEqual([text for _, text in measured.sentences], ["one", "two", "Three.", "Four, et al. 5."])

    def test_inline_code_is_one_word(self):
        self.assertEqual(markdown.measure_markdown("Run `aligngs demo --view` now.\n").words(), 3)

    def test_long_lines_are_found_but_no_tables(self):
        self.assertEqual(rules("x" * 121 + "\n"), ["121 columns"])
        self.assertEqual(rules("| " + "x" * 130 + " |\n"), [])

    def test_help_texts_are_read_from_options_and_commands(self):
        source = ('command->add_option("-o,--output", options.output, "file to write "\n  "(default: run)")->required();\n'
                  'log("not a help text");\ncommand->footer(help_footer({.example = "aligngs demo", .notes = "Of two words."}));')
        self.assertEqual([text for _, text in help_text.help_texts(source)],
                         ["file to write (default: run)", "aligngs demo", "Of two words."])
        self.assertEqual([f.rule for f in help_text.measure_help(source).findings], ['begins with "Of"'])


LONG = " ".join(["word"] * 26)


def comment_rules(source, suffix=".h"):
    return [finding.rule for finding in comment.measure_comments(source, suffix).findings]


def sentences(source, suffix=".h"):
    return [text for _, text in comment.measure_comments(source, suffix).sentences]


class Comments(unittest.TestCase):
    def test_length_first_words_and_private_words_are_found(self):
        self.assertEqual(comment_rules(f"// {LONG}.\n"), ["26 words"])
        self.assertEqual(comment_rules("/// Of the view.\n"), ['begins with "Of"'])
        self.assertEqual(comment_rules("int a;  // it does so unasked\n"), ['the words "unasked"'])

    def test_numbers_and_long_lines_are_no_findings(self):
        self.assertEqual(comment_rules(f"// 3 of 4, 5 of 6 {'x' * 130}\n"), [])

    def test_consecutive_lines_are_one_comment(self):
        self.assertEqual(sentences("// one\n// two. Three\n"), ["one two.", "Three"])
        self.assertEqual(sentences("int a;  ///< one\n        ///< two\n"), ["one two"])
        self.assertEqual(sentences("/* one\n * two */\n"), ["one two"])

    def test_comments_of_two_declarations_are_two(self):
        self.assertEqual(sentences("int a;  // one\nint b;  // two\n"), ["one", "two"])
        self.assertEqual(sentences("// one\n\n// two\n"), ["one", "two"])

    def test_an_empty_comment_line_ends_a_paragraph(self):
        self.assertEqual(sentences("// one\n//\n// two\n"), ["one", "two"])

    def test_a_sentence_may_begin_with_a_name_in_lower_case(self):
        self.assertEqual(sentences("// In metres. y points down, e.g. to the floor.\n"),
                         ["In metres.", "y points down, e.g. to the floor."])

    def test_items_and_indented_lines_are_paragraphs(self):
        self.assertEqual(sentences("// List:\n// - one\n//   more\n// - two\n// Text\n"), ["List:", "one more", "two", "Text"])
        self.assertEqual(sentences("// Text:\n//   one\n//     more\n//   two\n// rest\n"), ["Text:", "one more", "two", "rest"])

    def test_usage_and_columns_are_no_prose(self):
        self.assertEqual(sentences("// Usage: program FOLDER\n//   touch file      makes one\n"), [])

    def test_code_calls_and_formulas_are_one_word(self):
        for text in ("`a few words`", "f(x, y, z)", "[0, count)", "C = A + B * D", "w[i][j]"):
            self.assertEqual(len(sentences(f"// Set {text}, then stop.\n")[0].split()), 4, text)

    def test_a_product_and_an_omission_end_no_sentence(self):
        self.assertEqual(len(sentences("// The product a . b of min, ... and max.\n")), 1)

    def test_literals_hold_no_comment(self):
        self.assertEqual(sentences('auto a = "// one"; auto b = R"(// two)"; auto c = \'"\'; int d = 1\'000;  // three\n'), ["three"])
        self.assertEqual(sentences("const a = `// one`, b = /[/]/g, c = '//';  // two\n", ".ts"), ["two"])

    def test_a_finding_names_the_line_of_its_paragraph(self):
        self.assertEqual(comment.measure_comments("int a;\n\n// Of b.\n", ".h").findings[0].line, 3)


if __name__ == "__main__":
    unittest.main()
