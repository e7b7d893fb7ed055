"""Forward runs without memory: time at equal error, by all ways that springpot has to choose steps, and by MuJoCo, exudyn and SciPy on Pinocchio.

python benches/peers/smooth_runs.py [COMMAND] [TIMES]: COMMAND is springpot (default: target/release/springpot). Every method goes once through its
grid, tolerances a quarter of a decade apart or numbers of steps by a tenth of a decade, until its error is 1e-9 or a run takes over 1.5 s; these
runs are printed. Then, for every error asked for, each method's first setting of the grid that is at or below the error is run TIMES times
(default 7) in turn with the others'. The table has the medians, of a rival that of its fastest method, and their ratios to the first column's;
nothing is interpolated, and a dash is an error that the grid does not reach.
Error: the largest of q at the end, against SciPy's DOP853 at rtol 1e-13; where that is not installed, and for the stiff governor, against springpot.
Times leave out imports, reading and building. Of springpot it is the command's CPU time less that of a run of one step just before, and where that is
under 5 ms the difference of the case's own wall times; of the others the CPU time of the process.
Rivals that are not installed are left out (smooth_peers.py; needs NumPy). SciPy's steps and the forces of its elements are Python.
"""

import csv
import json
import math
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile

try:
    import smooth_peers
except ModuleNotFoundError:  # without NumPy
    smooth_peers = None

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


STIFF = {"flyball governor, 10 s"}
OURS = {"left out": None, "explicit": "explicit", "radau": "radau"}
ERRORS = [1e-3, 1e-6, 1e-9]
SHORT = 5e-3  # s
# Steps are at most a fiftieth of the run where nothing else is said: a short run would have fifty.
ONE_STEP = [word for key in ("time.end=1e-6", "time.output_times=[1e-6]", "solver.max_step=1", "solver.first_step=1e-6") for word in ("--set", key)]
LONGEST = 1.5  # s, the last run of a grid
TOLERANCES = [10 ** (-k / 4) for k in range(8, 53)]
STEPS = [round(10 ** (k / 10)) for k in range(15, 65)]


def spent(command, file, options):
    """(CPU time of a run, s; its case as run.json has it), or None where it is refused."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([command, "run", file, "--out", file.parent / "out", "--no-figures", *options], capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        return None
    case = json.loads((file.parent / "out/run.json").read_text())["cases"][0]
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, case


def run(command, file, rtol, method):
    """(seconds, q at the end, what the run counted), or None where the method does not take the case."""
    options = ["--set", f"solver.rtol={rtol}"] + (["--set", f'solver.method="{method}"'] if method else [])
    begin = spent(command, file, [*options, *ONE_STEP])
    whole = spent(command, file, options)
    if begin is None or whole is None:
        return None
    (cpu_begin, case_begin), (cpu, case) = begin, whole
    # CPU times of commands are uncertain by a millisecond, wall times of what takes long by what else the machine does.
    wall = case["wall_time"] - case_begin["wall_time"]
    seconds = wall if wall < SHORT else cpu - cpu_begin
    row = list(csv.DictReader((file.parent / "out/results.csv").open()))[-1]
    counts = f"steps {case['steps']} + {case['rejected_steps']} evaluations {case.get('evaluations') or 0} Newton {case['newton_iterations']}"
    return seconds, [float(value) for name, value in row.items() if name.startswith("q.")], counts


class Ours:
    """A way of springpot's to choose steps: from rtol to what `run` gives."""

    by_steps = False

    def __init__(self, command, file, method):
        self.asked = command, file, method

    def __call__(self, rtol):
        command, file, method = self.asked
        return run(command, file, rtol, method)


def error_of(q, truth):
    """The largest difference; coordinates of springpot alone, fingers at rest, stand last and are not compared."""
    errors = [abs(a - b) for a, b in zip(q, truth)]
    return max(errors) if all(map(math.isfinite, errors)) else math.inf


def through_grid(label, run, truth):
    """(error, setting) of a method's settings, from the loosest on."""
    found = []
    for setting in STEPS if run.by_steps else TOLERANCES:
        result = run(setting)
        if result is None:
            continue
        seconds, q, *counts = result
        error = error_of(q, truth)
        found.append((error, setting))
        print(f"{label:34} {setting:8.3g} error {error:7.1e} {1e3 * seconds:8.2f} ms", *counts, flush=True)
        if error <= ERRORS[-1] or seconds > LONGEST:
            break
    return found


def truth_of(name, ours, rivals):
    """The q that errors are measured against; says how far others at their narrowest are from it."""
    dop853 = rivals.get("SciPy + Pinocchio", {}).get("DOP853")
    narrow = {"SciPy DOP853 at 1e-13": dop853 and dop853(1e-13)}
    narrow |= {f"springpot {method} at {rtol}": ours[method](rtol) for method, rtol in [("explicit", 1e-13), ("radau", 1e-12)]}
    if name in STIFF:
        narrow = {"springpot radau at 1e-12": ours["radau"](1e-12)}
    if "MuJoCo" in rivals:
        narrow["MuJoCo RK4 in 160 000 steps"] = rivals["MuJoCo"]["RK4"](160000)
    (first, truth), *others = [(label, result[1]) for label, result in narrow.items() if result]
    print(f"{name}: against {first}", *(f"{label} {error_of(q, truth):.1e}" for label, q in others), sep=", ")
    return truth


def medians_of(name, columns, truth, times):
    """(error asked for, column) ↦ (ms, method), of the column's fastest method."""
    chosen = {}
    for column, methods in columns.items():
        for method, run in methods.items():
            grid = through_grid(f"{name[:14]} {column[:6]} {method}", run, truth)
            for asked in ERRORS:
                within = [setting for error, setting in grid if error <= asked]
                if within:
                    chosen[asked, column, method] = run, within[0]
    measured = {key: [] for key in chosen}
    for _ in range(times):
        for key, (run, setting) in chosen.items():
            measured[key].append(1e3 * run(setting)[0])
    best = {}
    for (asked, column, method), values in measured.items():
        found = statistics.median(values), method
        best[asked, column] = min(found, best.get((asked, column), found))
    return best


def rows(name, columns, truth, times):
    best = medians_of(name, columns, truth, times)
    first = next(iter(columns))
    for asked in ERRORS:
        cells = []
        for column, methods in columns.items():
            took, method = best.get((asked, column), (None, None))
            cell = f"{took:.2f}" if took else "–"
            if took and len(methods) > 1:
                cell += f" {method}"
            if took and column != first and (asked, first) in best:
                ratio = took / best[asked, first][0]
                cell += f", {ratio:.0f}×" if ratio >= 10 else f", {ratio:.2g}×"
            cells.append(cell)
        yield [name, f"{asked:.0e}", *cells]


def main():
    command = sys.argv[1] if len(sys.argv) > 1 else "target/release/springpot"
    times = int(sys.argv[2]) if len(sys.argv) > 2 else 7
    print("not installed:", ", ".join(smooth_peers.MISSING if smooth_peers else ["NumPy"]) or "none")
    names = [*OURS, *(smooth_peers.RIVALS if smooth_peers else [])]
    table = [["", "error", *names], ["---"] * (len(names) + 2)]
    with tempfile.TemporaryDirectory() as folder:
        for k, (name, text) in enumerate(CASES.items()):
            file = pathlib.Path(folder) / f"case{k}.toml"
            file.write_text(text)
            ours = {label: Ours(command, file, method) for label, method in OURS.items()}
            rivals = smooth_peers.peers(text, name in STIFF) if smooth_peers else {}
            truth = truth_of(name, ours, rivals)
            columns = {label: {label: method} for label, method in ours.items()}
            columns |= {rival: rivals.get(rival, {}) for rival in names[len(OURS) :]}
            table += rows(name, columns, truth, times)
    print("ms; times that of the first column")
    for row in table:
        print("|", " | ".join(row), "|")


main()
