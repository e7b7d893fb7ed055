"""What a law costs as a text: forward runs of a mass on a leaf, and on the expression that says the same force.

python benches/expressions.py [COMMAND]: COMMAND is springpot (default: target/release/springpot). 2 kg on a slide, 60 s at rtol 1e-9; seven runs of
each in turn, the medians of the time of the run a step, as run.json has both.
"""

import json
import pathlib
import statistics
import subprocess
import sys
import tempfile

LAWS = {
    "polynomial": (
        "polynomial(k1, k2, k3)",
        'expression("k1*x + k2*x^2 + k3*x^3", k1, k2, k3)',
        "k1 = 100, k2 = 500, k3 = 80000",
    ),
    "spring and dashpot": (
        "parallel(spring(k), dashpot(c))",
        'expression("k*x + c*v", k, c)',
        "k = 100, c = 0.001",
    ),
    "spring and friction": (
        "parallel(spring(k), friction(f, s))",
        'expression("k*x + f*tanh(v/s)", k, f, s)',
        "k = 100, f = 0.001, s = 0.02",
    ),
    "spring and stop": (
        "parallel(spring(k), stop(h, a, b))",
        'expression("k*x + h*(max(x - b, 0) + min(x - a, 0))", k, h, a, b)',
        "k = 30, h = 5000, a = -0.02, b = 0.02",
    ),
    "in a series": (
        "series(polynomial(k1, k2, k3), springpot(c, alpha))",
        'series(expression("k1*x + k2*x^2 + k3*x^3", k1, k2, k3), springpot(c, alpha))',
        "k1 = 100, k2 = 50, k3 = 80000, c = 20, alpha = 0.4",
    ),
}


def scenario(network, parameters):
    return (
        '[robot]\n[[robot.body]]\nname = "slide"\nmass = 2\n'
        'joint = { name = "s", kind = "prismatic", axis = [1, 0, 0] }\n'
        f"[[element]]\nname = \"e\"\njoint = \"s\"\nnetwork = '{network}'\nparameters = {{ {parameters} }}\n"
        '[motion]\nkind = "forward"\nstart = { q = { s = 0.04 }, v = { s = 0.3 } }\n'
        "[time]\nend = 60\noutput_step = 1\n[solver]\nrtol = 1e-9\n"
    )


def step(command, folder, name, text):
    """Microseconds a step."""
    (folder / f"{name}.toml").write_text(text)
    subprocess.run(
        [command, "run", f"{name}.toml", "--out", name, "--jobs", "1", "--quiet"],
        cwd=folder,
        check=True,
        capture_output=True,
    )
    case = json.loads((folder / name / "run.json").read_text())["cases"][0]
    return 1e6 * case["wall_time"] / case["steps"]


def main():
    command = str(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "target/release/springpot").resolve())
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        print("| law | leaf, µs a step | expression | ratio |\n|---|---|---|---|")
        for name, (leaf, text, parameters) in LAWS.items():
            times = {"leaf": [], "text": []}
            for _ in range(7):
                times["leaf"].append(step(command, folder, "leaf", scenario(leaf, parameters)))
                times["text"].append(step(command, folder, "text", scenario(text, parameters)))
            own, other = (statistics.median(times[kind]) for kind in ("leaf", "text"))
            print(f"| {name} | {own:.2f} | {other:.2f} | {other / own:.2f} |")


if __name__ == "__main__":
    main()
