"""links_test.py ROOT: every link and every path in README.md, CONTRIBUTING.md and the pages of docs leads to something that is
there: files, folders, and headings within a page. Pictures too."""

import glob
import os
import re
import sys
import unittest

ROOT = sys.argv[1]
PAGES = sorted(glob.glob(os.path.join(ROOT, "docs", "**", "*.md"), recursive=True) +
               [os.path.join(ROOT, name) for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")])
# The first folders of the sources: what is written as code and begins so names a file of the repository.
FOLDERS = sorted(name for name in os.listdir(ROOT) if os.path.isdir(os.path.join(ROOT, name)) and name not in ("build", "results"))


def text_of(page):
    with open(page, encoding="utf-8") as stream:
        return stream.read()


def prose_of(page):
    """The page without its blocks of code."""
    return re.sub(r"^```.*?^```$", "", text_of(page), flags=re.M | re.S)


def anchors_of(page):
    """As a forge makes them of headings: lower case, words joined by hyphens, nothing else."""
    found = set()
    for heading in re.findall(r"^#+ (.*)$", prose_of(page), flags=re.M):
        plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).lower()
        found.add(re.sub(r"[^\w\- ]", "", plain).strip().replace(" ", "-"))
    return found


def links_of(text):
    return re.findall(r"\]\(([^)\s]+)\)", text) + re.findall(r'(?:src|href)="([^"]+)"', text)


def paths_of(text):
    """What is written as code and looks like a path of the repository; names in capitals and patterns stand for many."""
    for code in re.findall(r"`([^`\n]+)`", text):
        for word in code.split():
            word = word.rstrip(",.;:")
            if re.fullmatch(r"[\w.][\w./-]*", word) and word.split("/")[0] in FOLDERS and "/" in word:
                if not re.search(r"(^|/)[A-Zx]+(\.\w+)?$", word):
                    yield word


def problems_of(page, text):
    folder = os.path.dirname(page)
    for link in links_of(text):
        if re.match(r"[a-z]+:", link):
            continue  # another site, which no test can ask
        name, _, anchor = link.partition("#")
        target = os.path.normpath(os.path.join(folder, name)) if name else page
        if not os.path.exists(target):
            yield f"{link} is not there"
        elif anchor and anchor not in anchors_of(target):
            yield f"{link} names no heading of its page"
    for path in paths_of(text):
        if not os.path.exists(os.path.join(ROOT, path)) and not glob.glob(os.path.join(ROOT, path) + ".*"):
            yield f"`{path}` is not there"


class Links(unittest.TestCase):
    def test_all_lead_somewhere(self):
        checked, problems = 0, []
        for page in PAGES:
            text = prose_of(page)
            checked += len(links_of(text))
            # These tell of files that a reader will add, and of files that are gone: links only.
            if os.path.basename(page) in ("CONTRIBUTING.md", "CHANGELOG.md"):
                text = "\n".join(f"]({link})" for link in links_of(text))
            problems += [f"{os.path.relpath(page, ROOT)}: {problem}" for problem in problems_of(page, text)]
        self.assertEqual(problems, [])
        self.assertGreater(checked, 50)

    def test_every_page_is_in_the_index(self):
        index = text_of(os.path.join(ROOT, "docs", "README.md"))
        for page in glob.glob(os.path.join(ROOT, "docs", "**", "*.md"), recursive=True):
            name = os.path.relpath(page, os.path.join(ROOT, "docs"))
            if name != "README.md":
                self.assertTrue(f"({name})" in index, f"docs/README.md does not lead to {name}")

    def test_every_picture_is_shown(self):
        shown = " ".join(text_of(page) for page in PAGES)
        pictures = (glob.glob(os.path.join(ROOT, "docs", "*.svg")) + glob.glob(os.path.join(ROOT, "docs", "*.png")) +
                    glob.glob(os.path.join(ROOT, "experiments", "figures", "*")))
        self.assertGreater(len(pictures), 3)
        for picture in pictures:
            self.assertTrue(os.path.basename(picture) in shown, f"no page shows {os.path.relpath(picture, ROOT)}")

    def test_what_is_wrong_is_found(self):
        here = os.path.join(ROOT, "docs", "README.md")
        self.assertEqual(len(list(problems_of(here, "[a](nowhere.md) [b](program.md#no-such) `docs/none.md` [c](program.md)"))), 3)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
