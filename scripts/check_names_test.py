#!/usr/bin/env python3
"""Tests of check_names.py."""
import pathlib
import tempfile
import unittest

import check_names


def source(hidden):
    return "namespace aligngs {\nnamespace {\n\n" + hidden + "\n\n}  // namespace\n}  // namespace aligngs\n"


class CheckNames(unittest.TestCase):
    def clashes(self, **files):
        """Of files of one module; the last _ of a name stands for the dot."""
        with tempfile.TemporaryDirectory() as folder:
            module = pathlib.Path(folder) / "src" / "io"
            module.mkdir(parents=True)
            for name, text in files.items():
                (module / ".".join(name.rsplit("_", 1))).write_text(text, encoding="utf-8")
            return [name for name, _ in check_names.clashes(module.parent)]

    def test_a_type_a_constant_and_a_function_of_two_files_are_found(self):
        hidden = source("struct Place {\n};\nconstexpr int kSide = 2;\nint twice(int x) { return 2 * x; }")
        self.assertEqual(self.clashes(a_cpp=hidden, b_cpp=hidden), ["Place", "kSide", "twice"])

    def test_a_function_with_another_body_is_found(self):
        one, other = source("int twice(int x) { return 2 * x; }"), source("int twice(int x) {\n  return x + x;\n}")
        self.assertEqual(self.clashes(a_cpp=one, b_cpp=other), ["twice"])

    def test_two_tests_meet_but_no_test_and_source(self):
        hidden = source("struct Place {\n};")
        self.assertEqual(self.clashes(a_test_cpp=hidden, b_test_cpp=hidden), ["Place"])
        self.assertEqual(self.clashes(a_cpp=hidden, a_test_cpp=hidden), [])

    def test_overloads_may_meet(self):
        one, other = source("int twice(int x) { return 2 * x; }"), source("float twice(float x) { return 2 * x; }")
        self.assertEqual(self.clashes(a_cpp=one, b_cpp=other), [])

    def test_an_alias_with_another_meaning_is_found(self):
        one, other = source("using Number = int;"), source("using Number = long;")
        self.assertEqual(self.clashes(a_cpp=one, b_cpp=other), ["Number"])

    def test_an_alias_with_the_same_meaning_may_come_again(self):
        self.assertEqual(self.clashes(a_cpp=source("using Number = int;"), b_cpp=source("using Number = int;")), [])

    def test_an_alias_with_the_name_of_a_type_is_found(self):
        self.assertEqual(self.clashes(a_cpp=source("using Place = int;"), b_cpp=source("struct Place {\n};")), ["Place"])

    def test_a_type_of_two_headers_is_found_even_in_two_namespaces(self):
        one = "namespace aligngs::cpu {\nstruct Place {\n  int x;\n};\n}  // namespace aligngs::cpu\n"
        other = "namespace aligngs::cuda {\nclass alignas(16) Place final : public Base {\n};\n}  // namespace aligngs::cuda\n"
        self.assertEqual(self.clashes(a_h=one, b_cuh=other), ["Place"])
        self.assertEqual(self.clashes(a_h=one, b_cpp=source("struct Place {\n};")), [])

    def test_a_declared_type_and_one_within_another_are_not_found(self):
        one = "namespace aligngs {\nstruct Place {\n  enum class Kind { kA };\n};\n}  // namespace aligngs\n"
        other = "namespace aligngs {\nstruct Place;\nstruct Other {\n  enum class Kind { kB };\n};\n}  // namespace aligngs\n"
        self.assertEqual(self.clashes(a_h=one, b_h=other), [])

    def test_a_constant_of_a_header_is_found(self):
        header = "namespace aligngs {\ninline constexpr int kSide = 3;\n}  // namespace aligngs\n"
        self.assertEqual(self.clashes(a_cpp=source("constexpr int kSide = 2;"), b_h=header), ["kSide"])

    def test_a_constant_of_another_namespace_may_have_the_name(self):
        header = "namespace aligngs::nn {\ninline constexpr int kSide = 3;\n}  // namespace aligngs::nn\n"
        self.assertEqual(self.clashes(a_cpp=source("constexpr int kSide = 2;"), b_h=header), [])


if __name__ == "__main__":
    unittest.main()
