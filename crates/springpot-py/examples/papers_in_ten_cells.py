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
# # Two papers in ten cells
#
# You learn how the generalized force of a strut with memory depends on its order, its temperature and its voltage: the figures of the two papers that
# Springpot began with. You also learn how to run a scenario, to sweep it, to take its columns apart and to draw them.
#
# The robot is a column, an upper arm and a forearm, and the strut joins the column with the forearm. `docs/LITERATURE.md` says how the papers were read.

# %% 1: what is needed
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import springpot as sp

# In a notebook there is no file; its folder is the current one.
HERE = Path(__file__).resolve().parent if "__file__" in globals() else Path.cwd()
SCENARIOS = HERE.parents[2] / "scenarios"

# %% 2: the laws of the papers
for name in ("thermoviscoelastic", "piezo-kelvin-voigt", "magnetorheological"):
    row = next(row for row in sp.laws() if row["name"] == name)
    print(f"{name:20} {row['equation']}")

# %% [markdown]
# ## The thermoviscoelastic strut
#
# The upper arm swings by 0.1 rad at 8 rad/s, the forearm turns slowly. A higher order makes the strut stronger, and its force comes earlier.

# %% 3: the generalized force for six orders at 25 °C
orders = sp.run(SCENARIOS / "thermoviscoelastic_order.toml")
ax = orders.plot("strut.Q.q2")
ax.set_title("Generalized force for six orders, 25 °C", fontsize="medium")
for case in orders.cases:
    Q = case["strut.Q.q2"]
    print(f"alpha = {case.parameters['element.strut.alpha']}: {Q.min():7.3f} … {Q.max():.3f} N·m")

# %% 4: the same for four temperatures
temperatures = sp.run(SCENARIOS / "thermoviscoelastic_temperature.toml")
ax = temperatures.plot("strut.Q.q2")
ax.set_title("Generalized force for four temperatures, alpha = 0.5", fontsize="medium")
# Over the whole run the temperatures are too near to one another to be told apart.
ax.set_xlim(8.5, 10)

# %% [markdown]
# Temperature acts beside the memory: 60 K take a_kv·E_kv·60 K = 0.84 N off the force at every time, and nothing else changes.

# %% 5: the force by hand, from the columns alone
cold, hot = temperatures.case(0), temperatures.case(3)
thermal = cold["strut.force"] - hot["strut.force"]
print(f"60 K take {thermal.min():.6f} … {thermal.max():.6f} N off the force")

half = sp.fractional.derivative(cold["t"], cold["strut.stroke"], 0.5)
by_hand = 50 * cold["strut.stroke"] + 50 * half
difference = np.abs(by_hand - cold["strut.force"]).max() / np.abs(cold["strut.force"]).max()
print(f"(E_c + E_kv)·x + E_d·D^½ x of the rows differs by {difference:.1e} of the largest force")

# %% [markdown]
# ## The piezo-modified strut
#
# The gripper follows a sinusoidal path at 0.2 Hz, the voltage alternates at 8 Hz. The strut is 17 mm longer than unloaded when the run begins, so that a
# Riemann–Liouville derivative is infinite at t = 0: that cell is empty.

# %% 6: six orders under an alternating and a constant voltage
piezo = sp.run(SCENARIOS / "piezo_order.toml")
fig, axes = plt.subplots(1, 2, figsize=(9.5, 3.6), sharey=True, layout="constrained")
for k, (ax, title) in enumerate(zip(axes, ("U = 60 V at 8 Hz", "U = 60 V"))):
    # The voltage is the last sweep, which runs fastest.
    piezo.plot("stack.Q.q2", cases=range(k, len(piezo), 2), ax=ax)
    ax.set_title(title, fontsize="medium")
    ax.set_ylim(-50, 100)

# %% 7: the ripple grows with the voltage, and with nothing else
ripple = sp.run(SCENARIOS / "piezo_voltage.toml")
ax = ripple.plot("stack.Q.q2")
ax.set_title("Generalized force for three voltages, alpha = 0.5", fontsize="medium")
ax.set(xlim=(0.5, 1.5), ylim=(30, 45))
quiet, once, twice = (case["stack.force"] for case in ripple.cases)
print(f"ripple of the force: {np.ptp(once - quiet) / 2:.3f} N and {np.ptp(twice - quiet) / 2:.3f} N")

# %% [markdown]
# ## The magnetorheological damper
#
# Its voltage stands before the memory, F = E_c·x + (mu_0 + u·mu)·D^alpha x: it scales what the damper remembers.

# %% 8: six orders at 1 V
damper = sp.run(SCENARIOS / "magnetorheological_order.toml")
ax = damper.plot("damper.Q.q2")
ax.set_title("Generalized force for six orders, 1 V", fontsize="medium")
ax.set_ylim(-50, 100)

# %% 9: loops of force and stroke for four voltages
coil = sp.run(SCENARIOS / "magnetorheological_voltage.toml")
ax = coil.plot("damper.force", x="damper.stroke")
ax.locator_params(axis="x", nbins=6)
ax.set_title("Loops for four voltages, alpha = 0.5", fontsize="medium")
lost = [case["damper.dissipated"][-1] for case in coil.cases]
for case, heat in zip(coil.cases, lost):
    print(f"{case.parameters['element.damper.u']:.0f} V: {heat:.3f} J lost in ten seconds")

# %% 10: what must hold
# Temperature and a piezo's voltage only add a force: a_kv·E_kv·60 K, and alpha_pz·E_pz·60 V.
assert np.allclose(thermal, 0.84, rtol=1e-9)
assert np.allclose(np.ptp(once - quiet) / 2, 10e-6 * 3000 * 60, rtol=1e-3)
assert np.allclose(twice - quiet, 2 * (once - quiet), atol=1e-9)
# The rows and the law alone give the force.
assert difference < 1e-6
# A magnetorheological voltage multiplies: at 3 V the loss is (50 + 30)/50 of that at 0 V.
assert np.allclose(np.array(lost) / lost[0], [1.0, 1.2, 1.4, 1.6], rtol=1e-6)
# A higher order makes the strut stronger.
assert (np.diff([case["strut.Q.q2"].max() for case in orders.cases]) > 0).all()
plt.show()
