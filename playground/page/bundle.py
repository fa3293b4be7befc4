"""bundle.py PLAYGROUND WASM OUT.html: puts page, worker, module and stored scenes into one file.

The sources are ES modules that import each other by name. In the page each script is one text: the files that it imports come
first, once each, without their import and export words. So no two of its files may declare the same name at the top."""

import base64
import gzip
import json
import os
import re
import sys

IMPORT = re.compile(r'^import \{[^}]*\} from "([^"]+)";\n', flags=re.M)
DECLARED = re.compile(r"^(?:async )?(?:function|class|const|let) ([A-Za-z_$][\w$]*)", flags=re.M)


def bundled(path, done):
    """The text of a module behind those that it imports."""
    path = os.path.normpath(path)
    if path in done:
        return ""
    done.append(path)
    with open(path, encoding="utf-8") as stream:
        text = stream.read()
    before = "".join(bundled(os.path.join(os.path.dirname(path), name), done) for name in IMPORT.findall(text))
    text = re.sub(r"^export ", "", IMPORT.sub("", text), flags=re.M)
    if re.search(r"^(import|export)\b", text, flags=re.M):
        sys.exit(f"bundle.py: {path} imports or exports in a way that is not known here")
    return before + text


def script(path):
    text = bundled(path, [])
    names = DECLARED.findall(text)
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        sys.exit(f"bundle.py: below {path} two files declare {', '.join(twice)}")
    if "</script" in text.lower():
        sys.exit(f"bundle.py: {path} holds the end of a script")
    return text


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    playground, wasm, out = sys.argv[1:]
    page = os.path.join(playground, "page")
    with open(wasm, "rb") as stream:
        binary = stream.read()
    packed = base64.b64encode(gzip.compress(binary, 9, mtime=0)).decode()
    with open(os.path.join(page, "stored_scenes.json"), encoding="utf-8") as stream:
        stored = json.dumps(json.load(stream), separators=(",", ":"))
    # A classic worker: modules in workers are not everywhere, and it loads nothing.
    worker = script(os.path.join(page, "worker.mjs")).replace("import.meta.url", "location.href")
    with open(os.path.join(page, "style.css"), encoding="utf-8") as stream:
        style = stream.read()
    parts = {"/*STYLE*/": style, "/*BYTES*/": packed, "/*WORKER*/": worker, "/*STORED*/": stored,
             "/*MAIN*/": script(os.path.join(page, "main.mjs"))}
    with open(os.path.join(page, "index.html"), encoding="utf-8") as stream:
        text = stream.read()
    for mark, part in parts.items():
        if text.count(mark) != 1:
            sys.exit(f"bundle.py: index.html must have {mark} once")
        text = text.replace(mark, part)
    temporary = out + ".part"
    with open(temporary, "w", encoding="utf-8") as stream:
        stream.write(text)
    os.replace(temporary, out)
    print(f"==> Page: {out}, {len(text.encode()) / 1e6:.2f} MB (module {len(binary) / 1e3:.0f} kB, {len(packed) / 1e3:.0f} kB in the page)")


if __name__ == "__main__":
    main()
