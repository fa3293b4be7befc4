"""An installed copy runs from where it was installed, with types and version.

python3 installed_test.py FOLDER
"""
import sys
from importlib import metadata
from pathlib import Path

import conelane
from conelane import ft_fsd, messages

folder = Path(sys.argv[1]).resolve() / "conelane"
for module in (conelane, ft_fsd, messages):
    assert Path(module.__file__).resolve().parent == folder, module.__file__
assert (folder / "py.typed").exists() and (folder / "_core.pyi").exists()
lane = conelane.Detector("front").detect([[x, y] for x in (2, 6, 10) for y in (-1.5, 1.5)], (0, 0, 0), time_limit_ms=None)
assert lane.left.tolist() == [1, 3, 5], lane
for installed in metadata.distributions(name="conelane", path=[str(folder.parent)]):  # by pip
    assert installed.version == conelane.__version__, installed.version
print(f"conelane {conelane.__version__} from {folder}")
