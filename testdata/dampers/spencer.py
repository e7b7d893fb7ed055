"""Spencer's damper under the standard sine test, to about 1e-10: SciPy's DOP853, split where x' - y' turns round.

    python testdata/dampers/spencer.py > testdata/dampers/spencer.json

y, z, w and the energies are integrated together as plain differential equations; the stored energy is not, and closes the balance
(printed to stderr). `sine` holds u, `steps` switches it at 0.3 s and 0.7 s.
"""

import json
import math
import sys

import numpy as np
from scipy.integrate import solve_ivp

# The published set of the prototype (Spencer, Dyke, Sain & Carlson 1997), N, m, s, V.
P = dict(c_0a=2100.0, c_0b=350.0, c_1a=28300.0, c_1b=295.0, k_0=4690.0, k_1=500.0, x_0=0.143,
         alpha_a=14000.0, alpha_b=69500.0, A=301.0, beta=3.63e6, gamma=3.63e6, n=2.0, eta=190.0)
OMEGA, SIZE, END, ROWS = 5.0 * math.pi, 0.015, 1.0, 200


def stroke(t):
    return SIZE * math.sin(OMEGA * t), SIZE * OMEGA * math.cos(OMEGA * t)


def parts(t, s, u):
    y, z, w = s[:3]
    x, v = stroke(t)
    c_0, c_1 = P["c_0a"] + P["c_0b"] * w, P["c_1a"] + P["c_1b"] * w
    alpha, w_rate = P["alpha_a"] + P["alpha_b"] * w, -P["eta"] * (w - u)
    y_rate = (alpha * z + c_0 * v + P["k_0"] * (x - y)) / (c_0 + c_1)
    return x, v, c_0, c_1, alpha, w_rate, y_rate, v - y_rate


def slopes(t, s, u, side):
    z = s[1]
    x, v, c_0, c_1, alpha, w_rate, y_rate, slip = parts(t, s, u)
    speed = side * slip
    z_rate = P["A"] * slip - P["gamma"] * speed * z * abs(z) ** (P["n"] - 1) - P["beta"] * slip * abs(z) ** P["n"]
    lost = alpha / P["A"] * (P["gamma"] * speed * abs(z) ** (P["n"] + 1) + P["beta"] * slip * z * abs(z) ** P["n"])
    force = c_1 * y_rate + P["k_1"] * (x - P["x_0"])
    return [y_rate, z_rate, w_rate, c_1 * y_rate**2 + c_0 * slip**2 + lost,
            0.5 * P["alpha_b"] * w_rate * z * z / P["A"], force * v]


def observed(t, s, u):
    x, v, c_0, c_1, alpha, _, y_rate, _ = parts(t, s, u)
    y, z = s[:2]
    force = c_1 * y_rate + P["k_1"] * (x - P["x_0"])
    stored = 0.5 * (P["k_1"] * (x - P["x_0"]) ** 2 + P["k_0"] * (x - y) ** 2 + alpha * z * z / P["A"])
    return force, stored


def run(command):
    """Rows [t, F, y, z, w, stored, dissipated, input]; `command` lists the times from which u holds, and u."""
    times = np.linspace(0.0, END, ROWS + 1)
    s, rows, worst = np.array([0.0, 0.0, command[0][1], 0.0, 0.0, 0.0]), [], 0.0
    stored_0 = observed(0.0, s, command[0][1])[1]
    for (start, u), (end, _) in zip(command, [*command[1:], (END, None)]):
        t = start
        while t < end:
            slip = parts(t, s, u)[-1]
            side = math.copysign(1.0, slip) if abs(slip) > 1e-12 else -side
            turn = lambda t, s: parts(t, s, u)[-1]
            turn.terminal, turn.direction = True, -side
            inside = times[(times >= t - 1e-15) & (times < end - 1e-15)]
            solution = solve_ivp(lambda t, s: slopes(t, s, u, side), (t, end), s, method="DOP853", rtol=1e-13,
                                 atol=1e-18, max_step=1e-4, events=turn, dense_output=True)
            last, s_last = solution.t[-1], solution.y[:, -1]
            for at in inside[inside <= last]:
                if not rows or at > rows[-1][0] + 1e-15:
                    here = solution.sol(at) if at > t else s
                    force, stored = observed(at, here, u)
                    worst = max(worst, abs(here[5] - (stored - stored_0) - here[3] + here[4]))
                    rows.append([float(at), float(force), *map(float, here[:3]), float(stored), float(here[3]), float(here[4])])
            t, s = last, s_last
    force, stored = observed(END, s, command[-1][1])
    rows.append([END, float(force), *map(float, s[:3]), float(stored), float(s[3]), float(s[4])])
    print(command, "balance", worst, "J of", s[3], file=sys.stderr)
    return [[f"{value:.15e}" for value in row] for row in rows]


cases = {f"sine {u} V": [(0.0, u)] for u in (0.0, 0.75, 1.5, 2.25)}
cases["steps"] = [(0.0, 0.0), (0.3, 2.25), (0.7, 0.5)]
out = {"parameters": P, "columns": ["t", "F", "y", "z", "w", "stored", "dissipated", "input"],
       "motion": "x = 0.015 sin(5 pi t)", "cases": {name: run(command) for name, command in cases.items()}}
json.dump(out, sys.stdout, indent=0)
