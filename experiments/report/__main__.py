"""report RESULTS PAGE PUBLISHED: RESULTS is the directory of a comparison, PUBLISHED a JSON object with the papers'
figures. Anything wrong with the input is one line on stderr and exit code 2."""

import json
import os
import sys
import tempfile

from .load import InputError, load_results
from .page import render


def write_whole(path, text):
    """Writes a file that appears under its name whole or not at all."""
    target = os.path.realpath(path)
    if os.path.exists(target) and not os.path.isfile(target):  # a pipe or device is written directly
        with open(target, "w", encoding="utf-8") as stream:
            stream.write(text)
        return
    folder = os.path.dirname(target)
    descriptor, temporary = tempfile.mkstemp(prefix=os.path.basename(target) + ".", dir=folder)
    try:
        with os.fdopen(descriptor, "w", encoding="utf-8") as stream:
            stream.write(text)
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(temporary, 0o666 & ~mask)
        os.replace(temporary, target)
    except BaseException:
        os.unlink(temporary)
        raise


def main(arguments):
    results, page, published = arguments
    try:
        write_whole(page, render(load_results(results), json.loads(published)))
    except InputError as error:
        print(f"conelane: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"conelane: {page}: {error.strerror}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
