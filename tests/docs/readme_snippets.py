"""readme_snippets.py ROOT FILE: the C++ blocks of README.md and docs/get-started.md as a program, with the names that they use defined
before them. The examples' time limits are without effect there: a pause of the machine breaks no page."""

import os
import re
import sys

BEFORE = """// Made of the C++ blocks of README.md and docs/get-started.md.
#include <iostream>
#include <vector>

namespace {

const std::vector<conelane::Cone> cones{{0, {2.0, -1.5}},  {1, {2.0, 1.5}},  {2, {6.0, -1.5}}, {3, {6.0, 1.5}},
                                        {4, {10.0, -1.4}}, {5, {10.0, 1.6}}, {6, {4.0, 4.0}}};
constexpr double x = 0.0;
constexpr double y = 0.0;
constexpr double yaw = 0.0;
int frames = 0;
bool driving() { return ++frames <= 3; }
double now_s() { return 0.1 * frames; }
void brake() { std::cout << "brake\\n"; }
void steer_along(const conelane::DrivableLane& lane, double safe_m, bool stop) {
    const bool drives = lane.points.size() > 5 && safe_m > 1.0 && !stop;
    std::cout << (drives ? "drive\\n" : "stop\\n");
}

}  // namespace

int main() {
"""
AFTER = """    std::cout << (course ? "course\\n" : "no course\\n");
    for (const auto id : answer.lane.left) std::cout << id << ' ';
    std::cout << '\\n';
}
"""


def main():
    root, file = sys.argv[1:]
    blocks = []
    for name in ("README.md", os.path.join("docs", "get-started.md")):
        with open(os.path.join(root, name), encoding="utf-8") as page:
            found = re.findall(r"^```cpp\n(.*?)^```", page.read(), flags=re.M | re.S)
        assert len(found) == 1, f"{name} has another number of C++ blocks"
        blocks += found
    lines = "".join(blocks).splitlines()
    lines = [re.sub(r"(\.time_limit_ms = )[\d.]+", r"\g<1>1e9", line) for line in lines]
    text = "".join(line + "\n" for line in lines if line.startswith("#include"))
    text += BEFORE + "".join("    " + line + "\n" for line in lines if not line.startswith("#include")) + AFTER
    with open(file, "w", encoding="utf-8") as source:
        source.write(text)


main()
