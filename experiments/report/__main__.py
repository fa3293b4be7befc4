"""report RESULTS PAGE PUBLISHED PICTURES: RESULTS is the directory of a comparison, PUBLISHED a JSON object with the
papers' figures, PICTURES a folder for the main figures as PNG or empty. Anything wrong with the input is one line on
stderr and exit code 2."""

import json
import os
import sys
import tempfile

from .load import InputError, load_results
from .page import render
from .pictures import pictures


def write_whole(path, content):
    """Writes a file (bytes) that appears under its name whole or not at all."""
    target = os.path.realpath(path)
    if os.path.exists(target) and not os.path.isfile(target):  # a pipe or device is written directly
        with open(target, "wb") as stream:
            stream.write(content)
        return
    folder = os.path.dirname(target)
    descriptor, temporary = tempfile.mkstemp(prefix=os.path.basename(target) + ".", dir=folder)
    try:
        with os.fdopen(descriptor, "wb") as stream:
            stream.write(content)
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(temporary, 0o666 & ~mask)
        os.replace(temporary, target)
    except BaseException:
        os.unlink(temporary)
        raise


def main(arguments):
    folder, page, published, picture_folder = arguments
    try:
        results = load_results(folder)
        if picture_folder:
            os.makedirs(picture_folder, exist_ok=True)
        write_whole(page, render(results, json.loads(published)).encode("utf-8"))
        if picture_folder:
            for name, content in pictures(results):
                write_whole(os.path.join(picture_folder, name), content)
    except InputError as error:
        print(f"conelane: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"conelane: {error.filename or page}: {error.strerror}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
