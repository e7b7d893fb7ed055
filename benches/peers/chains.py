"""Long chains: what a step costs from 20 to 200 links, and which method is left to choose.

python benches/peers/chains.py [COMMAND ...]: each COMMAND is springpot (default: target/release/springpot). Two metres of links, all alike, 4 kg,
a strut from the world to the last link, let go bent; 0.2 s at rtol 1e-6. Seven runs of each in turn, the medians of the command's CPU time less
that of a run of one step; steps as run.json has them.
"""

import json
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile

LINKS = [20, 50, 100, 200]
METHODS = ["", "radau", "explicit"]


def chain(links, end, method):
    length, mass = 2.0 / links, 4.0 / links
    turning = mass * length**2 / 12
    text = "[robot]\n"
    for k in range(links):
        text += (
            f'[[robot.body]]\nname = "b{k}"\njoint = {{ name = "q{k}", kind = "revolute", axis = [0, 1, 0], '
            f"origin = [{length if k else 0.0}, 0, 0], damping = {0.2 / links} }}\nmass = {mass}\ncom = [{length / 2}, 0, 0]\n"
            f"inertia = {{ xx = {turning}, yy = {turning}, zz = {turning} }}\n"
        )
    text += (
        '[[element]]\nname = "strut"\nfrom = { body = "world", point = [0.5, 0, 0.8] }\n'
        f'to = {{ body = "b{links - 1}", point = [{length}, 0, 0] }}\nrest_length = 1.4\n'
        'law = "kelvin-voigt"\nparameters = { k = 30, c = 2 }\n'
    )
    solver = f'method = "{method}"\n' if method else ""
    return text + (
        f'[motion]\nkind = "forward"\nstart = {{ q = {{ q0 = 0.3, q{links // 2} = 0.5 }} }}\n'
        f"[time]\nend = {end}\noutput_step = {end}\n[solver]\nrtol = 1e-6\n{solver}"
    )


def seconds(command, file):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out"
        arguments = [command, "run", str(file), "--no-figures", "--jobs", "1", "--out", str(out)]
        subprocess.run(arguments, check=True, capture_output=True)
        told = json.loads((out / "run.json").read_text())
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime, told


def main():
    commands = sys.argv[1:] or ["target/release/springpot"]
    print("| links | command | method | steps, explicit ones | ms | µs a step |\n|---|---|---|---|---|---|")
    for links in LINKS:
        with tempfile.TemporaryDirectory() as folder:
            times, told = {}, {}
            for _ in range(7):
                for command in commands:
                    for method in METHODS:
                        taken = []
                        for end in [1e-9, 0.2]:
                            file = pathlib.Path(folder) / "chain.toml"
                            file.write_text(chain(links, end, method))
                            spent, told[command, method] = seconds(command, file)
                            taken.append(spent)
                        times.setdefault((command, method), []).append(taken[1] - taken[0])
            for (command, method), spent in times.items():
                steps, explicit = (told[command, method].get(key) or 0 for key in ["steps", "explicit_steps"])
                median = statistics.median(spent)
                name = method or "left to choose"
                print(f"| {links} | {command} | {name} | {steps}, {explicit} | {1e3 * median:.1f} | {1e6 * median / steps:.0f} |")


if __name__ == "__main__":
    main()
