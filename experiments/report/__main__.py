"""report RESULTS PAGE PUBLISHED PICTURES TRACKS: RESULTS is the directory of a comparison, PUBLISHED a JSON object with
the papers' figures and the named conditions, PICTURES a folder for the main figures as PNG or empty, TRACKS those
whose laps the viewer shall have, separated by commas, or empty. Anything wrong with the input is one line on
stderr and exit code 2. The caller gives places of its own and puts the files where they are wanted when all is whole."""

import json
import os
import sys
import warnings

from .load import load_results
from .page import render
from .pictures import pictures
from .records import InputError


def write(path, content):
    with open(path, "wb") as stream:
        stream.write(content)


def main(arguments):
    folder, page, published, picture_folder, tracks = arguments
    warnings.simplefilter("ignore")  # of figures too small for their labels; nobody can do anything about them
    try:
        results = load_results(folder)
        if picture_folder:
            os.makedirs(picture_folder, exist_ok=True)
        write(page, render(results, json.loads(published), tuple(filter(None, tracks.split(",")))).encode("utf-8"))
        if picture_folder:
            for name, content in pictures(results):
                write(os.path.join(picture_folder, name), content)
    except InputError as error:
        print(f"conelane: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"conelane: {error.filename or page}: {error.strerror}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
