"""Derivatives of a fractional oscillator by its numbers, time against error: m x'' + c D^alpha x + k x = 0, x(0) = 1, x'(0) = 0, alpha = 1/2.

    python benches/peers/derivatives_of_runs.py target/release/springpot [ROUNDS]

prints a table: CPU time of x and its derivatives by k, c, m and alpha at 100 times up to 10 s, medians of rounds in turn, and the largest error in
units of the largest value of each derivative, against the inverse Laplace transform. Springpot is a process for each run, what a process takes that
runs nothing is taken away; the others are timed without their imports. Peers integrate the equation with exponential modes in place of the memory:
Gauss-Legendre nodes on each decade of rates, what is beyond both ends lumped into a spring and a dashpot, weights differentiated by alpha.
Needs NumPy, SciPy and mpmath; CasADi for CVODES.
"""

import math
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile
import time

import mpmath
import numpy as np
import scipy.integrate
import scipy.sparse

VALUES = {"k": 100.0, "c": 5.0, "m": 1.0, "alpha": 0.5}
PATHS = {"k": "element.pad.k", "c": "element.pad.c", "m": "robot.body.mass.mass", "alpha": "element.pad.alpha"}
END, ROWS = 10.0, 100
TIMES = np.linspace(0.0, END, ROWS + 1)[1:]
SCENARIO = """
robot.gravity = [0, 0, 0]
robot.body = [{{ name = "mass", joint = {{ name = "x", kind = "prismatic", axis = [1, 0, 0] }}, mass = {m} }}]
motion = {{ kind = "forward", start = {{ q = {{ x = 1 }} }} }}
time = {{ end = {end}, output_step = {step} }}
solver.rtol = {rtol}
output.columns = ["q.x"]
[[element]]
name = "pad"
joint = "x"
law = "fractional-kelvin-voigt"
parameters = {{ k = {k}, c = {c}, alpha = {alpha} }}
"""


def exact():
    """Derivatives at the times, one row for each number."""
    mpmath.mp.dps = 40
    k, c, m, a = (mpmath.mpf(VALUES[name]) for name in ("k", "c", "m", "alpha"))

    def parts(s):
        return m * s + c * s ** (a - 1), m * s * s + c * s**a + k

    def by_k(s):
        n, d = parts(s)
        return -n / d**2

    def by_c(s):
        n, d = parts(s)
        return (s ** (a - 1) * d - n * s**a) / d**2

    def by_m(s):
        n, d = parts(s)
        return (s * d - n * s * s) / d**2

    def by_alpha(s):
        return c * mpmath.log(s) * by_c(s)

    def inverse(f, t):
        # The contour has to go about the poles at 10i.
        return float(mpmath.invertlaplace(f, t, method="talbot", degree=40 + int(30 * t)))

    return np.array([[inverse(f, t) for t in TIMES] for f in (by_k, by_c, by_m, by_alpha)])


def error(found, reference):
    size = np.abs(reference).max(axis=1)
    return (np.abs(found - reference).max(axis=1) / size).max()


class Springpot:
    def __init__(self, program, folder):
        self.program, self.folder = program, pathlib.Path(folder)
        self.idle = statistics.median(self.run(1e-3, "", [], 1e-3)[1] for _ in range(9))

    def run(self, rtol, tables, more, end=END):
        """The columns behind t = 0, and how long the process took."""
        file, out = self.folder / "a.toml", self.folder / "out"
        file.write_text(SCENARIO.format(**VALUES, rtol=rtol, end=end, step=0.1 * end / END) + tables)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        command = [self.program, "run", file, "--no-figures", "--quiet", "--jobs", "1", "--out", out, *more]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        took = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        lines = (out / "results.csv").read_text().splitlines()[1:]
        return np.array([[float(cell) for cell in line.split(",")] for line in lines]).T, took

    def tangents(self, rtol):
        columns, took = self.run(rtol, "", ["--sensitivity", ",".join(PATHS.values())])
        return columns[-4:, 1:], took - self.idle

    def differences(self, rtol, share):
        """Central ones over this share of each number, eight cases of one sweep."""
        cases = []
        for moved in VALUES:
            for sign in (1, -1):
                cases.append([value * (1 + sign * share) if name == moved else value for name, value in VALUES.items()])
        sweep = f"[[sweep]]\nparameter = {list(PATHS.values())}\nvalues = {cases}\n"
        columns, took = self.run(rtol, sweep, [])
        x = columns[-1].reshape(4, 2, ROWS + 1)[:, :, 1:]
        wide = 2 * share * np.array(list(VALUES.values()))
        return (x[:, 0] - x[:, 1]) / wide[:, None], took - self.idle


class Modes:
    """The oscillator with modes: y' = A y for y = x, x', z, and A by each number."""

    def __init__(self, low, high, nodes):
        points, weights = np.polynomial.legendre.leggauss(nodes)
        decade = math.log(10)
        y = np.concatenate([decade * (d + 0.5 + 0.5 * points) for d in range(low, high)])
        self.rates, wide = np.exp(y), np.tile(0.5 * decade * weights, high - low)
        self.low, self.high, self.wide = 10.0**low, 10.0**high, wide
        self.size = 2 + len(self.rates)

    def kernel(self, a, sin, log, exp):
        """Weights of the modes, stiffness below the slowest, viscosity above the fastest."""
        front = sin(math.pi * a) / math.pi
        weights = [front * w * exp(a * math.log(r)) for w, r in zip(self.wide, self.rates)]
        return weights, front * exp(a * math.log(self.low)) / a, front * exp((a - 1) * math.log(self.high)) / (1 - a)

    def matrices(self):
        k, c, m, a = (VALUES[name] for name in ("k", "c", "m", "alpha"))
        weights, soft, stiff = self.kernel(a, math.sin, math.log, math.exp)
        front = math.pi / math.tan(math.pi * a)
        by = [w * (front + math.log(r)) for w, r in zip(weights, self.rates)]
        by_soft = soft * (front + math.log(self.low) - 1 / a)
        by_stiff = stiff * (front + math.log(self.high) + 1 / (1 - a))

        def row(x, v, z):
            return scipy.sparse.coo_matrix((np.concatenate([[x, v], z]), (np.ones(self.size, int), np.arange(self.size))), (self.size,) * 2)

        pull = np.array([soft, stiff, *weights])
        held = np.array([k, 0.0, *np.zeros(len(weights))])
        force = held + c * pull
        n = len(self.rates)
        plain = scipy.sparse.lil_matrix((self.size,) * 2)
        plain[0, 1] = 1.0
        for j in range(n):
            plain[2 + j, 1], plain[2 + j, 2 + j] = 1.0, -self.rates[j]
        of = lambda f: row(f[0], f[1], f[2:])
        plain = plain.tocsc() + of(-force / m).tocsc()
        # The spring of the slowest modes pulls from where the run began.
        start = np.zeros(self.size)
        start[1] = c * soft / m
        changes = []
        for name in VALUES:
            push = np.zeros(self.size)
            if name == "k":
                change = of(-np.array([1.0, 0.0, *np.zeros(n)]) / m)
            elif name == "c":
                change, push[1] = of(-pull / m), soft / m
            elif name == "m":
                change, push[1] = of(force / m**2), -c * soft / m**2
            else:
                change, push[1] = of(-c * np.array([by_soft, by_stiff, *by]) / m), c * by_soft / m
            changes.append((change.tocsc(), push))
        return plain, start, changes

    def scipy(self, method, rtol):
        plain, start, changes = self.matrices()
        blocks = [[plain, *[None] * 4]]
        for i, (change, _) in enumerate(changes):
            blocks.append([change, *[plain if j == i else None for j in range(4)]])
        matrix = scipy.sparse.bmat(blocks, format="csc")
        push = np.concatenate([start, *(push for _, push in changes)])
        first = np.zeros(5 * self.size)
        first[0] = 1.0
        fast = matrix.tocsr()
        begun = time.process_time()
        found = scipy.integrate.solve_ivp(
            lambda t, y: fast @ y + push, (0, END), first, method, TIMES, jac=matrix, rtol=rtol, atol=rtol * 1e-2
        )
        took = time.process_time() - begun
        return found.y[[self.size * (1 + i) for i in range(4)]], took

    def cvodes(self, rtol):
        import casadi

        p, y = casadi.SX.sym("p", 4), casadi.SX.sym("y", self.size)
        k, c, m, a = (p[i] for i in range(4))
        weights, soft, stiff = self.kernel(a, casadi.sin, casadi.log, casadi.exp)
        pull = soft * (y[0] - 1) + stiff * y[1] + casadi.dot(casadi.vertcat(*weights), y[2:])
        slope = casadi.vertcat(y[1], -(k * y[0] + c * pull) / m, y[1] - casadi.DM(self.rates) * y[2:])
        options = {"reltol": rtol, "abstol": rtol * 1e-2, "fsens_err_con": True, "max_num_steps": 1000000}
        grid = [0.0, *TIMES]
        run = casadi.integrator("run", "cvodes", {"x": y, "p": p, "ode": slope}, 0.0, grid[1:], options)
        first = casadi.DM.zeros(self.size)
        first[0] = 1
        at = casadi.MX.sym("at", 4)
        told = run(x0=first, p=at)["xf"][0, :]
        derivative = casadi.Function("derivative", [at], [casadi.jacobian(told, at)])
        values = casadi.DM(list(VALUES.values()))
        derivative(values)
        begun = time.process_time()
        found = np.array(derivative(values)).T
        return found, time.process_time() - begun


def predictor_corrector(steps):
    """Adams-Bashforth-Moulton steps of order 1/2 (Diethelm, Ford, Freed 2002), as packages of one order take them: x, D^1/2 x, x', D^1/2 x'
    and their derivatives by k, c and m. By alpha there are none: the order is that of the whole system."""
    k, c, m = (VALUES[name] for name in ("k", "c", "m"))
    a = np.zeros((4, 4))
    a[0, 1] = a[1, 2] = a[2, 3] = 1.0
    a[3, 0], a[3, 1] = -k / m, -c / m
    by = [np.zeros((4, 4)) for _ in range(3)]
    by[0][3, 0], by[1][3, 1] = -1 / m, -1 / m
    by[2][3, 0], by[2][3, 1] = k / m**2, c / m**2
    whole = np.zeros((16, 16))
    whole[:4, :4] = a
    for i, change in enumerate(by):
        at = slice(4 + 4 * i, 8 + 4 * i)
        whole[at, :4], whole[at, at] = change, a
    order, h = 0.5, END / steps
    begun = time.process_time()
    j = np.arange(steps + 1, dtype=float)
    predict = h**order / order * ((j + 1) ** order - j**order)
    correct = (j + 2) ** (order + 1) + j ** (order + 1) - 2 * (j + 1) ** (order + 1)
    front = h**order / (order * (order + 1))
    y, f = np.zeros((steps + 1, 16)), np.zeros((steps + 1, 16))
    y[0, 0] = 1.0
    f[0] = whole @ y[0]
    gamma = math.gamma(order)
    for n in range(steps):
        guess = y[0] + predict[n::-1] @ f[: n + 1] / gamma
        first = n ** (order + 1) - (n - order) * (n + 1) ** order
        past = first * f[0] + (correct[n - 1 :: -1] @ f[1 : n + 1] if n else 0.0)
        y[n + 1] = y[0] + front * (past + whole @ guess) / gamma
        f[n + 1] = whole @ y[n + 1]
    took = time.process_time() - begun
    rows = np.arange(1, ROWS + 1) * (steps // ROWS)
    return np.vstack([y[rows][:, [4, 8, 12]].T, np.full(ROWS, np.nan)]), took


def main():
    program, rounds = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 5
    reference = exact()
    few, many = Modes(-4, 5, 5), Modes(-6, 8, 8)
    entries = []
    with tempfile.TemporaryDirectory() as folder:
        springpot = Springpot(program, folder)
        for rtol in (1e-4, 1e-6, 1e-8, 1e-10):
            modes = few if rtol > 1e-7 else many
            entries.append((f"Springpot, tangents, rtol {rtol:.0e}", lambda rtol=rtol: springpot.tangents(rtol)))
            # In favour of differences: over the share that errs least.
            shares = [rtol ** (1 / 3) / 3**i for i in range(5)]
            share = min(shares, key=lambda share: error(springpot.differences(rtol, share)[0], reference))
            name = f"Springpot, central differences over {share:.0e}, rtol {rtol:.0e}"
            entries.append((name, lambda rtol=rtol, share=share: springpot.differences(rtol, share)))
            for method in ("Radau", "BDF"):
                if method == "BDF" or rtol > 1e-9:
                    run = lambda rtol=rtol, modes=modes, method=method: modes.scipy(method, rtol)
                    entries.append((f"{modes.size - 2} modes, SciPy {method}, rtol {rtol:.0e}", run))
            try:
                import casadi  # noqa: F401

                entries.append((f"{modes.size - 2} modes, CVODES, rtol {rtol:.0e}", lambda rtol=rtol, modes=modes: modes.cvodes(rtol)))
            except ImportError:
                pass
        for steps in (1000, 4000, 16000):
            entries.append((f"predictor-corrector of order 1/2, {steps} steps", lambda steps=steps: predictor_corrector(steps)))
        times, errors = {name: [] for name, _ in entries}, {}
        for _ in range(rounds):
            for name, run in entries:
                found, took = run()
                times[name].append(took)
                known = ~np.isnan(found).any(axis=1)
                errors[name] = error(found[known], reference[known])
        print(f"a process that runs nothing: {1e3 * springpot.idle:.1f} ms")
    for name, took in times.items():
        print(f"| {name} | {1e3 * statistics.median(took):.3g} ms | {errors[name]:.1e} |")


main()
