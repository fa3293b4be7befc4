"""colors_test.py STYLE: the colours of the methods in style.css can be told apart, by readers with any colour vision too,
and stand out from the page, light and dark."""

import itertools
import re
import sys
import unittest

import numpy as np

STYLE = sys.argv[1]
# Machado, Oliveira and Fernandes 2009, severity 1, on linear RGB.
VISION = {
    "normal": np.eye(3),
    "protanopia": np.array([[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]),
    "deuteranopia": np.array([[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]),
    "tritanopia": np.array([[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]])}
LEAST_DISTANCE = 20.0  # CIELAB; 2.3 is just noticeable
LEAST_CONTRAST = 3.0  # WCAG, of graphical objects


def linear(color):
    parts = np.array([int(color[i:i + 2], 16) for i in (1, 3, 5)]) / 255
    return np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)


def lab(rgb):
    xyz = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]) @ np.clip(rgb, 0, 1)
    ratio = xyz / np.array([0.95047, 1.0, 1.08883])
    f = np.where(ratio > 0.008856, np.cbrt(ratio), 7.787 * ratio + 16 / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def contrast(one, other):
    darker, lighter = sorted(float(np.array([0.2126, 0.7152, 0.0722]) @ linear(color)) for color in (one, other))
    return (lighter + 0.05) / (darker + 0.05)


class Colours(unittest.TestCase):
    def test_methods_and_sides_can_be_told_apart(self):
        with open(STYLE, encoding="utf-8") as stream:
            blocks = [dict(re.findall(r"--(\w+): (#[0-9a-f]{6})", block))
                      for block in re.findall(r"\{([^{}]*--m0[^{}]*)\}", stream.read())]
        self.assertEqual(len(blocks), 3)  # light, dark by choice, dark by the system
        self.assertEqual(blocks[1], blocks[2])
        for block in blocks[:2]:
            for ground, names in (("surface", [f"m{i}" for i in range(8)]), ("raised", ["left", "right"])):
                for name in names:
                    self.assertGreaterEqual(contrast(block[name], block[ground]), LEAST_CONTRAST, name)
                for vision, matrix in VISION.items():
                    for one, other in itertools.combinations(names, 2):
                        distance = np.linalg.norm(lab(matrix @ linear(block[one])) - lab(matrix @ linear(block[other])))
                        self.assertGreater(distance, LEAST_DISTANCE, (vision, one, other))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
