"""Reads JSON and JSON Lines, and refuses what is not as it has to be. experiments/tables reads by it too, without numpy."""

import json
import math
import re
import sys

NUMBER, WHOLE, TEXT, YES_OR_NO = (int, float), (int,), (str,), (bool,)


class InputError(ValueError):
    """Names the file and, where there is one, the line and the key."""


def run(main):
    """Calls main(arguments) as a program: a file that is wrong, or cannot be written, is one line on stderr and exit code 2."""
    try:
        main(sys.argv[1:])
    except (InputError, OSError) as error:
        said = f"{error.filename}: {error.strerror}" if isinstance(error, OSError) else error
        print(f"conelane: {said}", file=sys.stderr)
        sys.exit(2)


def label_of(method, nearest):
    """How a method on a cone set is called in every table, as in results.jsonl's own table."""
    return method if nearest is None else f"{method} n={nearest}"


_SCENE_AT_START = re.compile(r'\{"(?:id|scene)":"([^"\\]*)"')


def read_lines(path, scenes=None):
    """Yields (line number, object) of a file in JSON Lines. With `scenes`, lines that begin with the id of another
    scene are passed over unread: lanes with all their candidates are large."""
    try:
        stream = open(path, encoding="utf-8")
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from None
    with stream:
        number = 0
        try:
            for number, line in enumerate(stream, 1):
                start = _SCENE_AT_START.match(line) if scenes is not None else None
                if not line.strip() or (start and start[1] not in scenes):
                    continue
                value = json.loads(line)
                if not isinstance(value, dict):
                    raise InputError(f"{path}:{number}: no JSON object")
                yield number, value
        except (json.JSONDecodeError, UnicodeDecodeError) as error:
            raise InputError(f"{path}:{number}: {error}") from None


def read_json(path, kind=dict):
    """A file that holds one object, or one list."""
    try:
        with open(path, encoding="utf-8") as stream:
            value = json.load(stream)
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from None
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: {error}") from None
    if not isinstance(value, kind):
        raise InputError(f"{path}: no JSON {'object' if kind is dict else 'list'}")
    return value


def require(path, number, value, key, kinds):
    """value[key], where it is there and of one of these kinds."""
    if key not in value:
        raise InputError(f"{path}:{number}: {key}: is missing")
    found = value[key]
    if not isinstance(found, kinds) or (isinstance(found, bool) and bool not in kinds):
        raise InputError(f"{path}:{number}: {key}: has a value of the wrong kind")
    if isinstance(found, float) and not math.isfinite(found):
        raise InputError(f"{path}:{number}: {key}: is not finite")
    return found


def require_all(path, number, value, kinds):
    """As require, of each key of `kinds`; a key that ends in ? may be missing, and kinds of kinds are of an object."""
    for key, kind in kinds.items():
        name = key.removesuffix("?")
        if name == key or name in value:
            found = require(path, number, value, name, dict if isinstance(kind, dict) else kind)
            if isinstance(kind, dict):
                require_all(path, number, found, kind)
