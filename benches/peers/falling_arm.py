"""The falling three-body arm with SciPy: Radau on the state extended by the exponentials of the memory.

Reads lines of JSON {"end": …, "rates": […], "weights": […], "fast": …} from the standard input: the run's length and the exponentials
of D^alpha x = sum_k w_k z_k + fast x', z_k' = -lambda_k z_k + x', where the last term stands for what is faster than all of them. Answers each with lines "RTOL SECONDS Q1 Q2 Q3 V1 V2 V3", one for each tolerance
of the grid below, then "done", so that a caller can run it side by side with its own code. Needs numpy and scipy.
"""

import json
import math
import sys
import time

import numpy as np
from scipy.integrate import solve_ivp

TOLERANCES = (1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9)

GRAVITY = np.array([0.0, 0.0, -9.81])
AXES = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
ORIGINS = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.6], [0.5, 0.0, 0.0]])
MASSES = np.array([6.0, 3.0, 2.0])
CENTRES = np.array([[0.02, 0.0, 0.3], [0.25, 0.01, 0.02], [0.18, -0.01, 0.01]])
INERTIAS = np.array(
    [
        [[0.20, 0.0, 0.01], [0.0, 0.20, 0.0], [0.01, 0.0, 0.06]],
        [[0.01, 0.001, 0.0], [0.001, 0.07, 0.0005], [0.0, 0.0005, 0.07]],
        [[0.006, 0.0, -0.001], [0.0, 0.03, 0.0004], [-0.001, 0.0004, 0.03]],
    ]
)
FROM, TO, REST = np.array([0.14, -0.1, 0.08]), np.array([-0.06, 0.1, 0.08]), 0.7
STIFFNESS, VISCOSITY, DRIVE = 50.0, 50.0, 0.0007 * 20.0 * 25.0


def turn(axis, angle):
    s, c = math.sin(angle), math.cos(angle)
    x, y, z = axis
    k = 1.0 - c
    return np.array(
        [
            [k * x * x + c, k * x * y - s * z, k * x * z + s * y],
            [k * x * y + s * z, k * y * y + c, k * y * z - s * x],
            [k * x * z - s * y, k * y * z + s * x, k * z * z + c],
        ]
    )


def cross(a, b):
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def arm(q, v):
    """Mass matrix, C v + g, length, its rate and its gradient."""
    rotation, origin = np.eye(3), np.zeros(3)
    omega, speed = np.zeros(3), np.zeros(3)
    alpha, push = np.zeros(3), -GRAVITY
    axes, origins, columns = [], [], []
    mass, bias = np.zeros((3, 3)), np.zeros(3)
    points = []
    for i in range(3):
        arm_ = rotation @ ORIGINS[i]
        push = push + cross(alpha, arm_) + cross(omega, cross(omega, arm_))
        speed = speed + cross(omega, arm_)
        origin = origin + arm_
        axis = rotation @ AXES[i]
        alpha = alpha + cross(omega, axis) * v[i]
        omega = omega + axis * v[i]
        rotation = rotation @ turn(AXES[i], q[i])
        axes.append(axis)
        origins.append(origin)
        centre = rotation @ CENTRES[i]
        inertia = rotation @ INERTIAS[i] @ rotation.T
        turns = np.array(axes)
        moves = np.array([cross(axes[j], origin + centre - origins[j]) for j in range(i + 1)])
        mass[: i + 1, : i + 1] += MASSES[i] * moves @ moves.T + turns @ inertia @ turns.T
        force = MASSES[i] * (push + cross(alpha, centre) + cross(omega, cross(omega, centre)))
        moment = inertia @ alpha + cross(omega, inertia @ omega)
        bias[: i + 1] += moves @ force + turns @ moment
        if i in (0, 2):
            local = rotation @ (FROM if i == 0 else TO)
            gradient = np.zeros((3, 3))
            for j in range(i + 1):
                gradient[j] = cross(axes[j], origin + local - origins[j])
            points.append((origin + local, gradient))
    line = points[1][0] - points[0][0]
    length = math.sqrt(line @ line)
    gradient = (points[1][1] - points[0][1]) @ (line / length)
    return mass, bias, length, gradient


def run(end, rates, weights, fast, rtol):
    def slope(_, y):
        q, v, z = y[:3], y[3:6], y[6:]
        mass, bias, length, gradient = arm(q, v)
        rate = gradient @ v
        force = STIFFNESS * (length - REST) + VISCOSITY * (weights @ z + fast * rate) - DRIVE
        return np.concatenate([v, np.linalg.solve(mass, -bias - gradient * force), rate - rates * z])

    start = time.perf_counter()
    result = solve_ivp(slope, (0.0, end), np.zeros(6 + len(rates)), method="Radau", rtol=rtol, atol=rtol, t_eval=[end])
    return time.perf_counter() - start, result.y[:6, -1]


def main():
    for line in sys.stdin:
        case = json.loads(line)
        rates, weights = np.array(case["rates"]), np.array(case["weights"])
        for rtol in TOLERANCES:
            seconds, y = run(case["end"], rates, weights, case["fast"], rtol)
            print(rtol, seconds, *map(repr, map(float, y)), flush=True)
        print("done", flush=True)


if __name__ == "__main__":
    main()
