# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3
#     name: python3
# ---

# %% [markdown]
# # A UR5 on a rubber mount
#
# You learn how a value of a data sheet, tan δ at 10 Hz, becomes a law with memory between two links of a robot from its URDF file. The arm is let go: it
# drops on its mount and settles, and two numbers that follow from the law alone say how fast it swings and how fast that dies.

# %%
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import brentq

import springpot as sp

# In a notebook there is no file; its folder is the current one.
HERE = Path(__file__).resolve().parent if "__file__" in globals() else Path.cwd()
UR5 = HERE.parents[2] / "testdata" / "multibody" / "ur5.urdf"
ELBOW = "elbow_joint"

# %% [markdown]
# ## From the data sheet to a law
#
# The sheet gives a stiffness at rest, and at 10 Hz a storage modulus and tan δ. They determine k, c and alpha of F = k·x + c·D^alpha x. Three
# compounds differ in tan δ alone.

# %%
compounds = {}
for tan_delta in (0.1, 0.25, 0.4):
    law, deviation = sp.datasheet([("stiffness", "20 kN/m", 0), ("storage", "30 kN/m", "10 Hz"), ("tan_delta", tan_delta, "10 Hz")])
    assert deviation < 1e-12
    compounds[tan_delta] = law
    print(f"tan δ = {tan_delta:4}: {law}")

# %% [markdown]
# ## The arm
#
# The mount crosses the elbow, from the upper arm to the forearm. All other joints are locked. `rest_length = "start"`: the rubber is unloaded as the
# arm is let go.

# %%
UPPER = {"body": "upper_arm_link", "point": [0, -0.1197, 0.275]}
FORE = {"body": "forearm_link", "point": [0, 0, 0.15]}
rubber = compounds[0.25]

scenario = {
    "title": "A UR5 drops on a rubber mount",
    # The meshes are not needed, and the file's words for a simulator are not read.
    "robot": {"urdf": str(UR5), "accept": ["mesh-not-found", "not-used"]},
    "element": [{"name": "mount", "from": UPPER, "to": FORE, "rest_length": "start", **rubber.description}],
    "motion": {
        "kind": "forward",
        "start": {"q": {"shoulder_lift_joint": "-70 deg", ELBOW: "100 deg"}},
        "locked": ["shoulder_pan_joint", "shoulder_lift_joint", "wrist_1_joint", "wrist_2_joint", "wrist_3_joint"],
    },
    "time": {"end": "6 s", "output_step": "2 ms"},
    "metric": [
        {"name": "frequency", "of": f"q.{ELBOW}", "kind": "frequency", "window": ["0.6 s", "2 s"]},
        {"name": "decrement", "of": f"q.{ELBOW}", "kind": "log-decrement", "window": ["0.6 s", "2 s"]},
    ],
}
laws = [(law.parameters["k"], law.parameters["c"], law.parameters["alpha"]) for law in compounds.values()]
run = sp.run(scenario, sweep={("element.mount.k", "element.mount.c", "element.mount.alpha"): laws})
print(run)

# %%
fig, ax = plt.subplots(figsize=(5.9, 3.6), layout="constrained")
for tan_delta, case in zip(compounds, run.cases):
    ax.plot(case["t"], np.rad2deg(case[f"q.{ELBOW}"]), linewidth=1.4, label=f"tan δ = {tan_delta}")
ax.set(xlabel="t, s", ylabel="angle of the elbow, deg", xlim=(0, 3))
ax.set_title("Let go at 100°, it drops and settles", loc="left", fontsize="medium")
ax.grid(True, color="0.9", linewidth=0.6)
ax.legend(frameon=False, fontsize="small")

# %% [markdown]
# ## Where the energy goes
#
# What the arm loses in height is stored in the rubber, turned into heat there, or still moves. The residual of that balance measures the run.

# %%
case = run.case(1)
shares = {
    "height": case["energy.potential"] - case["energy.potential"][0],
    "motion": case["energy.kinetic"],
    "stored in the rubber": case["mount.stored"],
    "heat": case["mount.dissipated"],
}
fig, ax = plt.subplots(figsize=(5.9, 3.6), layout="constrained")
for label, energy in shares.items():
    ax.plot(case["t"], energy, linewidth=1.4, label=label)
ax.set(xlabel="t, s", ylabel="energy, J", xlim=(0, 3))
ax.set_title("Energies of the drop, tan δ = 0.25", loc="left", fontsize="medium")
ax.grid(True, color="0.9", linewidth=0.6)
ax.legend(frameon=False, fontsize="small")
residual = max(np.abs(case["energy.residual"]).max() for case in run.cases)
print(f"the balance of energies is kept to {residual:.1e} J")

# %% [markdown]
# ## The mode, from the law alone
#
# Near rest the elbow obeys M s² + K(s)·g² + G = 0 with K(s) = k + c·s^alpha, g = ∂l/∂q and G from gravity and the turning lever. Its complex
# root is the mode: Im s the frequency, Re s the decay.

# %%
robot = sp.Model.from_urdf(UR5)
PLACE = robot.v_names.index(ELBOW)
start = np.zeros(robot.nq)
start[robot.joint_names.index("shoulder_lift_joint")] = np.deg2rad(-70)
start[PLACE] = np.deg2rad(100)


def lever(angle):
    """Length of the mount, m, and its derivative by the elbow, m/rad."""
    q = start.copy()
    q[PLACE] = angle
    length, gradient = robot.pair_length((UPPER["body"], UPPER["point"]), (FORE["body"], FORE["point"]), q)
    return length, gradient[PLACE]


def load(angle, force):
    """The torque that the arm wants at the elbow under a force of the mount, N·m."""
    q = start.copy()
    q[PLACE] = angle
    return robot.gravity(q)[PLACE] + force * lever(angle)[1]


rest_length = lever(start[PLACE])[0]


def mode(law):
    """The angle at rest, rad, and the root s, 1/s."""
    k, c, alpha = (law.parameters[name] for name in ("k", "c", "alpha"))
    angle = brentq(lambda angle: load(angle, k * (lever(angle)[0] - rest_length)), start[PLACE], start[PLACE] + 0.5)
    q = start.copy()
    q[PLACE] = angle
    mass, g, force = robot.crba(q)[PLACE, PLACE], lever(angle)[1], k * (lever(angle)[0] - rest_length)
    shift = 1e-5
    geometric = (load(angle + shift, force) - load(angle - shift, force)) / (2 * shift)
    s = 1j * np.sqrt(k * g**2 / mass)
    for _ in range(50):
        s = 1j * np.sqrt(((k + c * s**alpha) * g**2 + geometric) / mass)
    return angle, s


print("tan δ   rest: law, run, deg   frequency: law, run, Hz   decrement: law, run")
found = []
for (tan_delta, law), case, frequency, decrement in zip(
    compounds.items(), run.cases, run.metrics["frequency"], run.metrics["decrement"]
):
    angle, s = mode(law)
    at_rest, hertz, decay = np.rad2deg(angle), s.imag / (2 * np.pi), -2 * np.pi * s.real / s.imag
    last = np.rad2deg(case[f"q.{ELBOW}"][-1])
    found.append((at_rest, last, hertz, frequency, decay, decrement))
    print(f"{tan_delta:5}   {at_rest:10.3f} {last:10.3f} {hertz:14.3f} {frequency:8.3f} {decay:15.3f} {decrement:8.3f}")

# %%
for at_rest, last, hertz, frequency, decay, decrement in found:
    # Rubber creeps, the longer the lower its order: what is left after six seconds is t^−alpha of the way.
    assert 0 < at_rest - last < 0.15 * (at_rest - 100)
    assert abs(frequency / hertz - 1) < 0.02
    assert abs(decrement / decay - 1) < 0.1
assert residual < 1e-6
plt.show()
