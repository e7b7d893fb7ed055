"""Algorithms of rigid bodies beside Pinocchio's best build: header-only, clang, for this processor alone.

python benches/peers/algorithms.py [ROUNDS [SAMPLES]]: builds algorithms.cpp with clang++ against the headers of the wheels pin and cmeel-eigen of this
interpreter, and `cargo bench -p springpot --bench batch`, which is a plain build; runs one after the other ROUNDS times (default 5), SAMPLES samples (default
21) of each work in turn in either, on the robots of testdata/multibody. Printed: how many times as long Pinocchio takes for one state, the median of the rounds.
Every work begins with q, v, a and ends with its result; of Pinocchio's ways to it the fastest counts. Equal results: test_pinocchio.py and the oracles of `--test rigid`.
"""

import json
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile

import pinocchio as pin

ROOT = pathlib.Path(__file__).resolve().parents[2]
ROBOTS = {"ur5": ("ur5", False), "humanoid": ("simple_humanoid", False), "floating": ("simple_humanoid", True)}
WORKS = ["placements", "rnea", "crba", "aba", "mass inverse", "coriolis", "rnea derivatives", "aba derivatives", "frame jacobian"]
# What Pinocchio's own build passes to Boost.
FLAGS = ["-std=c++17", "-O3", "-march=native", "-DNDEBUG", "-DBOOST_FUSION_INVOKE_MAX_ARITY=12", "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS"]
FLAGS += ["-DBOOST_MPL_LIMIT_LIST_SIZE=30", "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30"]


def robot(name, is_floating):
    """The robot as algorithms.cpp reads it: what the library has read, since its own layout is not that of a build for this processor."""
    path = str(ROOT / "testdata" / "multibody" / f"{name}.urdf")
    model = pin.buildModelFromUrdf(path, pin.JointModelFreeFlyer()) if is_floating else pin.buildModelFromUrdf(path)
    lines = []
    for k in range(1, model.njoints):
        kind = model.joints[k].shortname().removeprefix("JointModel")
        short = {"RevoluteUnaligned": "RU", "PrismaticUnaligned": "PU"}.get(kind, kind)
        axis = model.joints[k].extract().axis if short in ("RU", "PU") else [0, 0, 0]
        place, body = model.jointPlacements[k], model.inertias[k]
        numbers = [*axis, *place.rotation.ravel(), *place.translation, body.mass, *body.lever, *body.inertia.ravel()]
        lines.append(f"joint {model.parents[k]} {short} " + " ".join(repr(float(x)) for x in numbers))
    return "\n".join([*lines, f"tip {model.njoints - 1}", ""])


def build(folder):
    clang = os.environ.get("CXX") or shutil.which("clang++") or sys.exit("clang++ is needed (or another compiler by CXX)")
    headers = pathlib.Path(pin.__file__).parents[4] / "include"
    program = folder / "algorithms"
    source = pathlib.Path(__file__).with_suffix(".cpp")
    subprocess.run([clang, *FLAGS, f"-I{headers}", f"-I{headers / 'eigen3'}", "-o", program, source], check=True)
    order = ["cargo", "bench", "-p", "springpot", "--bench", "batch", "--no-run", "--message-format=json"]
    lines = subprocess.run(order, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout.splitlines()
    ours = [json.loads(line).get("executable") for line in lines if '"batch"' in line and '"executable":"' in line]
    return program, ours[-1]


def theirs(program, text, samples):
    done = subprocess.run([program, samples], input=text, capture_output=True, text=True, check=True)
    cells = [line.split("\t") for line in done.stdout.splitlines()]
    return {name: {"one": float(time)} for name, time, *_ in cells}


def ours(program, name, samples):
    lines = subprocess.run([program, samples, name], capture_output=True, text=True, check=True).stdout.splitlines()
    found = {}
    for line in lines[1:]:
        words = line[26:].split()
        found[line[2:19].strip()] = {"one": float(line[19:26]), **dict(zip(words[::3], map(float, words[1::3])))}
    return found


def main():
    rounds, samples = sys.argv[1:] + ["5", "21"][len(sys.argv) - 1 :]
    with tempfile.TemporaryDirectory() as folder:
        pinocchio, springpot = build(pathlib.Path(folder))
        texts = {name: robot(*what) for name, what in ROBOTS.items()}
        ratios, times = {}, {}
        for _ in range(int(rounds)):
            for name, text in texts.items():
                a, b = theirs(pinocchio, text, samples), ours(springpot, name, samples)
                for work in WORKS:
                    for level, time in b[work].items():
                        ratios.setdefault((name, level), {}).setdefault(work, []).append(a[work]["one"] / time)
                        times.setdefault((name, level), {}).setdefault(work, []).append(time)
                    times.setdefault((name, "Pinocchio"), {}).setdefault(work, []).append(a[work]["one"])
    print("| Pinocchio's time / ours | " + " | ".join(WORKS) + " |\n|" + "---|" * (len(WORKS) + 1))
    for (name, level), row in ratios.items():
        cells = [f"{statistics.median(row[work]):.2f}" if work in row else "" for work in WORKS]
        print(f"| {name}, {level} | " + " | ".join(cells) + " |")
    print("\n| ns | " + " | ".join(WORKS) + " |\n|" + "---|" * (len(WORKS) + 1))
    for (name, level), row in times.items():
        cells = [f"{statistics.median(row[work]):.0f}" if work in row else "" for work in WORKS]
        print(f"| {name}, {level} | " + " | ".join(cells) + " |")


main()
