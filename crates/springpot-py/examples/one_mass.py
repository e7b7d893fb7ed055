"""One mass on a springpot, with SciPy and `sp.Bank` alone.

    python one_mass.py M C ALPHA K FORCE X0 V0 T1 [T2 …]

integrates m x'' + c D^alpha x + k x = f (Caputo, x(0) = X0, x'(0) = V0, a constant force) and prints x at the times, as CSV.

A step of size h is a Radau collocation in the acceleration: with its values a at the three nodes, x' = v0 + h A a and x = x0 + h c v0 + h² A² a.
The bank answers with forces F and their tangents G, P at the nodes; both are linear here, so that one linear system gives a.
"""

import sys
from dataclasses import dataclass

import numpy as np
from scipy import linalg

import springpot as sp

# The error of one step, in units of the largest stroke so far; steps add up to far below 1e-5.
TOLERANCE = 1e-9


@dataclass
class OneMass:
    """m x'' + F(history of x) + k x = f."""

    mass: float
    stiffness: float
    force: float
    bank: sp.Bank

    def step(self, t: float, h: float, x0: float, v0: float) -> tuple[float, float]:
        """Solves a step, takes it into the memory, and gives x and x' at its end."""
        matrix = self.bank.matrix_of_nodes
        to_rate, to_stroke = h * matrix, h**2 * matrix @ matrix
        guess, rate = x0 + h * self.bank.nodes * v0, np.full(3, v0)
        force, by_stroke, by_rate = self.forces(t, h, guess, rate)
        system = (
            self.mass * np.eye(3) + (self.stiffness * np.eye(3) + by_stroke) @ to_stroke + by_rate @ to_rate
        )
        a = linalg.solve(system, self.force - self.stiffness * guess - force)
        x, v = guess + to_stroke @ a, rate + to_rate @ a
        if len(self.bank):
            self.forces(t, h, x, v)
            self.bank.commit()
        return float(x[-1]), float(v[-1])

    def forces(self, t: float, h: float, x: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        if not len(self.bank):
            return np.zeros(3), np.zeros((3, 3)), np.zeros((3, 3))
        force, by_stroke, by_rate = self.bank.evaluate(t, h, [x], [v])
        return force[0], by_stroke[0], by_rate[0]


def solve(
    mass: float, c: float, alpha: float, k: float, force: float, x0: float, v0: float, times: list[float]
) -> dict[float, float]:
    """x at the times, s."""
    end = max(times)
    laws = [sp.law("springpot", c=c, alpha=alpha)] if c > 0.0 else []
    bank = sp.Bank(laws, tolerance=1e-12, step=1e-4 * (end or 1.0), horizon=max(end, 1e-9))
    body = OneMass(mass, k, force, bank)
    if laws:
        bank.begin([x0], [v0])
    t, x, v, h = 0.0, x0, v0, 1e-4 * end
    largest, found = abs(x0), {0.0: x0}
    for stop in sorted(set(times) - {0.0}):
        while t < stop:
            h = min(h, stop - t)
            # A remainder that is no step of its own is shared with the step before it.
            if h < stop - t < 2 * h:
                h = 0.5 * (stop - t)
            before = bank.state() if laws else None
            coarse, _ = body.step(t, h, x, v)
            if before is not None:
                bank.set_state(before)
            half = body.step(t, 0.5 * h, x, v)
            fine = body.step(t + 0.5 * h, 0.5 * h, *half)
            scale = max(largest, abs(fine[0]), 1e-300)
            error = abs(fine[0] - coarse) / scale
            factor = min(3.0, max(0.2, 0.9 * (TOLERANCE / max(error, 1e-300)) ** (1 / 6)))
            if error > TOLERANCE and h > 1e-12 * end:
                if before is not None:
                    bank.set_state(before)
                h *= factor
                continue
            t = stop if stop - t <= h * (1 + 1e-12) else t + h
            (x, v), h, largest = fine, h * factor, scale
        found[stop] = x
    return found


def main(arguments: list[str]) -> int:
    if len(arguments) < 8:
        print("usage: one_mass.py M C ALPHA K FORCE X0 V0 T1 [T2 …]", file=sys.stderr)
        return 2
    try:
        m, c, alpha, k, force, x0, v0, *times = map(float, arguments)
        if not (np.isfinite([m, c, alpha, k, force, x0, v0, *times]).all() and m > 0.0 and min(times) >= 0.0):
            raise ValueError("numbers must be finite, M positive, and times not negative")
        found = solve(m, c, alpha, k, force, x0, v0, times)
    except ValueError as error:
        print(error, file=sys.stderr)
        return 2
    print("t,x")
    for t in times:
        print(f"{t!r},{found[t]!r}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
