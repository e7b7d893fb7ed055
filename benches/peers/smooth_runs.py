"""Forward runs without memory: work and time at equal error, by both methods that choose their steps and by the run's own choice.

python benches/peers/smooth_runs.py [COMMAND] [TIMES]: COMMAND is springpot (default: target/release/springpot), each run is done TIMES times (default 7)
in turn with the others, and the median of its case's own time is told. Errors are the largest of q at the end against rtol 1e-12.
"""

import csv
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile

SCENARIOS = pathlib.Path(__file__).resolve().parents[2] / "scenarios"
STRUT = 'law = "kelvin-voigt"\nparameters = {{ k = {k}, c = {c} }}\n'


def element(name, from_body, from_point, to_body, to_point, rest, k, c):
    return (
        f'[[element]]\nname = "{name}"\nfrom = {{ body = "{from_body}", point = {from_point} }}\n'
        f'to = {{ body = "{to_body}", point = {to_point} }}\nrest_length = {rest}\n' + STRUT.format(k=k, c=c)
    )


def chain(links, length, mass, damping):
    text = "[robot]\n"
    for k in range(links):
        parent = f'parent = "b{k - 1}"\n' if k else ""
        z = -length if k else 0.0
        text += (
            f'[[robot.body]]\nname = "b{k}"\n{parent}joint = {{ name = "q{k}", kind = "revolute", axis = [0, 1, 0], '
            f"origin = [0, 0, {z}], damping = {damping} }}\nmass = {mass}\ncom = [0, 0, {-length / 2}]\n"
            f"inertia = {{ xx = {mass * length**2 / 12}, yy = {mass * length**2 / 12}, zz = {1e-3 * mass * length**2} }}\n"
        )
    return text


def time(end):
    return f"[time]\nend = {end}\noutput_times = [{end}]\n"


def governor():
    text = (SCENARIOS / "flyball_governor.toml").read_text()
    lines, keep = [], True
    for line in text.splitlines():
        if line.startswith("["):
            keep = line.strip() not in ("[time]", "[solver]", "[output]", "[[figure]]")
        if keep:
            lines.append(line)
    return "\n".join(lines) + "\n" + time(10)


def panda():
    text = f'[robot]\nurdf = "{SCENARIOS / "robots/panda.urdf"}"\naccept = ["unknown-attribute", "mesh-not-found", "not-used"]\n'
    text += element("strut", "world", [0.35, 0.1, 0], "panda_link4", [0, 0, 0.1], 0.78, 400, 30)
    text += element("elbow", "panda_link2", [0.04, -0.14, 0], "panda_link4", [-0.02, 0.18, 0], 0.25, 400, 20)
    start = "panda_joint2 = -0.35, panda_joint4 = -1.92, panda_joint6 = 1.75, panda_joint7 = 0.79"
    return text + f'[motion]\nkind = "forward"\nstart = {{ q = {{ {start} }} }}\n' + time(2)


CASES = {
    "double pendulum, 10 s": chain(2, 1.0, 1.0, 0.0)
    + element("strut", "world", [0.5, 0, 0.3], "b1", [0, 0, -0.6], 1.4, 30, 0.5)
    + '[motion]\nkind = "forward"\nstart = { q = { q0 = 1.0, q1 = 0.5 } }\n'
    + time(10),
    "Panda with two struts, 2 s": panda(),
    "chain of 20, 2 s": chain(20, 0.1, 0.2, 2e-3)
    + element("strut", "world", [0.4, 0, -0.2], "b10", [0, 0, -0.05], 0.9, 20, 0.5)
    + '[motion]\nkind = "forward"\nstart = { q = { q0 = 0.6, q5 = 0.2 } }\n'
    + time(2),
    "flyball governor, 10 s": governor(),
}


def run(command, file, rtol, method):
    out = file.parent / "out"
    options = ["--set", f"solver.rtol={rtol}"] + (["--set", f'solver.method="{method}"'] if method else [])
    done = subprocess.run([command, "run", file, "--out", out, "--no-figures", *options], capture_output=True, text=True)
    if done.returncode:
        return None
    case = json.loads((out / "run.json").read_text())["cases"][0]
    row = list(csv.DictReader((out / "results.csv").open()))[-1]
    return case, [float(value) for name, value in row.items() if name.startswith("q.")]


def main():
    command = sys.argv[1] if len(sys.argv) > 1 else "target/release/springpot"
    times = int(sys.argv[2]) if len(sys.argv) > 2 else 7
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "case.toml"
        for name, text in CASES.items():
            file.write_text(text)
            _, truth = run(command, file, 1e-12, "radau")
            for rtol in [1e-3, 1e-4, 1e-6, 1e-7, 1e-9, 1e-10]:
                walls = {method: [] for method in ["radau", "explicit", ""]}
                last = {}
                for _ in range(times):
                    for method, own in walls.items():
                        result = run(command, file, rtol, method)
                        if result:
                            own.append(1e3 * result[0]["wall_time"])
                            last[method] = result
                for method, (case, q) in last.items():
                    error = max(abs(a - b) for a, b in zip(q, truth))
                    print(
                        f"{name:28} rtol {rtol:5.0e} {method or 'chosen':8} error {error:7.1e} steps {case['steps']:6} "
                        f"+ {case['rejected_steps']:3} evaluations {case.get('evaluations') or 0:6} "
                        f"Newton {case['newton_iterations']:6} {statistics.median(walls[method]):8.2f} ms"
                    )


main()
