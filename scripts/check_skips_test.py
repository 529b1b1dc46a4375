#!/usr/bin/env python3
"""Tests of check_skips.py."""
import pathlib
import tempfile
import unittest

import check_skips

RESULTS = """<?xml version="1.0"?>
<testsuite>
  <testcase name="A.Passes" status="run"><system-out>[       OK ] A.Passes</system-out></testcase>
  <testcase name="B.NeedsTiles" status="notrun"><skipped message="SKIP_REGULAR_EXPRESSION_MATCHED"/>
    <system-out>[ RUN      ] B.NeedsTiles
/src/b_test.cpp:21: Skipped
this processor has no matrix tiles

[  SKIPPED ] B.NeedsTiles (0 ms)</system-out></testcase>
  <testcase name="C.NeedsData" status="notrun"><skipped message="SKIP_REGULAR_EXPRESSION_MATCHED"/>
    <system-out>/src/c_test.cpp:9: Skipped
"../shared/data" is not here
</system-out></testcase>
  <testcase name="script" status="notrun"><skipped message="SKIP_RETURN_CODE=77"/>
    <system-out>skipped: node is not installed (scripts/setup.sh --browser)</system-out></testcase>
</testsuite>
"""


class CheckSkips(unittest.TestCase):
    def skipped(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "results.xml"
            file.write_text(RESULTS, encoding="utf-8")
            return list(check_skips.skipped_tests(file))

    def test_reasons_of_programs_and_of_scripts_are_found(self):
        self.assertEqual(self.skipped(), [
            ("B.NeedsTiles", "this processor has no matrix tiles"),
            ("C.NeedsData", '"../shared/data" is not here'),
            ("script", "node is not installed (scripts/setup.sh --browser)")])

    def test_missing_data_is_no_reason_of_a_machine(self):
        allowed = check_skips.patterns(check_skips.ALLOWED.read_text(encoding="utf-8"))
        self.assertEqual([name for name, _ in check_skips.not_allowed(self.skipped(), allowed)], ["C.NeedsData"])

    def test_a_skip_without_a_reason_is_not_allowed(self):
        allowed = check_skips.patterns(check_skips.ALLOWED.read_text(encoding="utf-8"))
        self.assertTrue(check_skips.not_allowed([("D", "")], allowed))


if __name__ == "__main__":
    unittest.main()
