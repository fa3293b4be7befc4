"""words_test.py ROOT: no document, comment or message of the project has a phrase of words.py or a commit hash out of its place; a planted
one is found, across line breaks too; the README and the page of style stay short."""

import os
import sys
import unittest

import words

ROOT = sys.argv[1]


def found(name, text):
    return [(line, what) for line, what, _ in words.problems_of(name, text)]


class Project(unittest.TestCase):
    def test_has_none_of_the_phrases(self):
        names = words.files_of(ROOT)
        self.assertGreater(len(names), 500)
        problems = []
        for name in names:
            with open(os.path.join(ROOT, name), encoding="utf-8") as stream:
                problems += [f"{name}:{line}: {what}; write: {instead}" for line, what, instead in words.problems_of(name, stream.read())]
        self.assertEqual(problems, [], "see docs/style.md")

    def test_short_pages_stay_short(self):
        for name, most in (("README.md", 120), ("docs/style.md", 60)):
            with open(os.path.join(ROOT, name), encoding="utf-8") as stream:
                self.assertLessEqual(len(stream.readlines()), most, name)


class Planted(unittest.TestCase):
    def test_in_a_document(self):
        self.assertEqual(found("docs/a.md", "One line.\n\nThese are limits that are no limits.\n"), [(3, '"limits that are no limits"')])

    def test_across_a_line_break_of_a_document(self):
        self.assertEqual(found("docs/a.md", "It was measured on a\nloaded machine.\n"), [(1, '"on a loaded machine"')])
        self.assertEqual(found("docs/a.md", "- an item that is right all\n  but surely\n"), [(1, '"right all but surely"')])

    def test_across_a_line_break_of_comments(self):
        for mark in ("///", "//", "#"):
            text = f"int a;\n    {mark} probability that the\n    {mark} lane is right\n"
            self.assertEqual(found("a.hpp", text), [(2, '"probability that the lane is right"')], mark)
        self.assertEqual(found("a.hpp", "int a = 0;  ///< once it\n            ///< has struck\n"), [(1, '"once it has struck"')])

    def test_across_the_strings_of_a_message(self):
        self.assertEqual(found("a.cpp", 'throw Error("an edge that "\n            "is none");\n'), [(1, '"that is none"')])

    def test_does_not_cross_a_paragraph(self):
        self.assertEqual(found("docs/a.md", "It is on a\n\nloaded machine.\n"), [])

    def test_commit_hash(self):
        self.assertEqual(found("docs/a.md", "as\nof 38b87a6.\n"), [(2, "commit hash 38b87a6")])
        self.assertEqual(found("a.cpp", "// by 1d9df23\n"), [(1, "commit hash 1d9df23")])
        for name in ("docs/benchmarks/0.6.md", "CHANGELOG.md"):
            self.assertEqual(found(name, "by 38b87a6\n"), [], name)
        for text in ("0x38b87a6f", "1500000", "defaced", "1234567e5", "e74213e5a976d08f", "%0500000d", "abc/38b87a6/x"):
            self.assertEqual(found("docs/a.md", text + "\n"), [], text)

    def test_diary_of_a_document(self):
        self.assertEqual(found("docs/a.md", "Times before and after the change.\n"), [(1, '"before and after"')])
        self.assertEqual(found("a.cpp", "// the cones before and after it\n"), [])
        self.assertEqual(found("docs/a.md", "18 us at n = 12 (26 before)\n"), [(1, '"(26 before)"')])

    def test_line_of_what_is_found(self):
        self.assertEqual(found("a.hpp", "a\nb\n\n// c\n// such ones\n"), [(5, '"such ones"')])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
