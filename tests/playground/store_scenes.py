"""store_scenes.py PROGRAM OUT.json: ten scenes of generated courses with the lanes that the native program finds in them, for
the page's test of itself. The test playground.stored_scenes compares what it writes with stored_scenes.json."""

import json
import os
import subprocess
import sys
import tempfile

TRACKS = ["hairpins", "circle", "curvy", "kidney", "gates@2"]  # where the exact solver needs less than a second
RATES = ["0.1", "0.4"]
METHODS = ["front", "clc", "rld-pair"]
ANSWER = ["method", "status", "left", "right", "closed"]


def read(path):
    with open(path, encoding="utf-8") as stream:
        return [json.loads(line) for line in stream]


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    program, out = sys.argv[1:]

    def run(*arguments):
        subprocess.run([program, *arguments], check=True, stdout=subprocess.DEVNULL)

    with tempfile.TemporaryDirectory() as folder:
        every, chosen = os.path.join(folder, "all.scenes.jsonl"), os.path.join(folder, "s.scenes.jsonl")
        run("scenes", "--tracks", "generated:" + ",".join(TRACKS), "--condition", "car", "--fp", ",".join(RATES), "--range", "30",
            "--every", "20", "--seed", "1", "--out", every)
        laps = {}
        for scene in read(every):
            laps.setdefault((scene["track"], scene["false_positive_rate"]), []).append(scene)
        scenes = [lap[len(lap) // 3] for _, lap in sorted(laps.items())]
        with open(chosen, "w", encoding="utf-8") as stream:
            stream.writelines(json.dumps(scene) + "\n" for scene in scenes)
        answers = []
        for method in METHODS:
            lanes = os.path.join(folder, method + ".lanes.jsonl")
            run("detect", "--method", method, "--time-limit", "100000", "--scenes", chosen, "--out", lanes)
            answers.append(read(lanes))
            for lane in answers[-1]:
                if lane.get("stopped_by", "iterations") != "iterations":
                    sys.exit(f"store_scenes.py: {method} was stopped in {lane['scene']}: its lane depends on the machine")
    stored = []
    for i, scene in enumerate(scenes):
        cones = [{key: cone[key] for key in ("id", "x", "y")} for cone in scene["cones"]]
        kept = {"id": scene["id"], "pose": scene["pose"], "cones": cones}
        stored.append({"scene": kept, "answers": [{key: lanes[i][key] for key in ANSWER} for lanes in answers]})
    with open(out, "w", encoding="utf-8") as stream:
        stream.write("[\n" + ",\n".join(json.dumps(one) for one in stored) + "\n]\n")


if __name__ == "__main__":
    main()
