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
# # A controller in Python against a magnetorheological damper
#
# You learn how a function of Python commands the voltage of a damper, sampled as on a real controller. A carriage carries a tool on a leaf spring from
# point to point, and the skyhook law leaves less than half of the vibration that the best of five constant voltages leaves.

# %%
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import springpot as sp

# In a notebook there is no file; its folder is the current one.
HERE = Path(__file__).resolve().parent if "__file__" in globals() else Path.cwd()
SCENARIO = HERE.parents[2] / "scenarios" / "tool_damper.toml"
VOLTS = 2.0

# %% [markdown]
# ## The controller
#
# A force of the damper can only oppose the stroke's rate. Skyhook: voltage while that also slows the tool itself down, none while it would drag
# it along. `q` and `v` are the carriage's place and the tool's place on it.

# %%


def skyhook(t, q, v):
    """The voltage of the damper, V."""
    rate, tool = v[1], v[0] + v[1]
    # Below 3 cm/s the damper stays off: its friction would hold the tool off its place.
    return VOLTS if rate * tool > 1e-3 else 0.0


# %%
times = np.linspace(0, 3, 601)


def swing(voltage, sample="1 ms"):
    """Place of the tool on its carriage, mm, and voltage, V, at the times."""
    asked = (voltage, sample) if callable(voltage) else voltage
    simulation = sp.Simulation(SCENARIO, inputs={"damper.u": asked})
    place, volts = [], []
    for t in times:
        simulation.step_to(t)
        now = simulation.snapshot()
        place.append(1e3 * now["q.tool"])
        volts.append(now["damper.u"])
    return np.array(place), np.array(volts)


laws = {"0 V": "0 V", "0.3 V": "300 mV", "0.5 V": "500 mV", "1 V": 1.0, "2 V": 2.0, "skyhook": skyhook}
places, volts = {}, {}
for name, law in laws.items():
    places[name], volts[name] = swing(law)

# %% [markdown]
# ## What is left of the vibration
#
# The carriage stands from 0.4 s on. What is left is the root mean square of the tool's distance from its place after 0.5 s; it has settled once it
# stays within half a millimetre.


# %%
def residual(place):
    """Root mean square from 0.5 s on, mm."""
    return np.sqrt(np.mean(place[times >= 0.5] ** 2))


def settled(place):
    """When it comes to stay within half a millimetre, s; infinite where it does not."""
    outside = np.flatnonzero(np.abs(place) > 0.5)[-1]
    return times[outside + 1] if outside + 1 < times.size else np.inf


print("voltage   residual, mm   settled, s   off at 3 s, mm")
for name, place in places.items():
    print(f"{name:9} {residual(place):10.3f} {settled(place):12.3f} {abs(place[-1]):14.3f}")

# %%
fig, (above, below) = plt.subplots(2, 1, figsize=(5.9, 5.2), sharex=True, height_ratios=[2, 1], layout="constrained")
for name in ("0 V", "1 V", "2 V", "skyhook"):
    above.plot(times, places[name], linewidth=1.4, label=name)
above.set(ylabel="tool on its carriage, mm")
above.set_title("A tool carried 0.3 m far in 0.4 s", loc="left", fontsize="medium")
above.legend(frameon=False, fontsize="small")
below.step(times, volts["skyhook"], where="post", color="C3", linewidth=1.0)
below.set(xlabel="t, s", ylabel="skyhook, V", xlim=(0, 1.5))
for ax in (above, below):
    ax.grid(True, color="0.9", linewidth=0.6)

# %% [markdown]
# ## How fast must it be?
#
# The same law at slower clocks. Ten milliseconds, a twentieth of the tool's period, are still enough.

# %%
for clock in ("1 ms", "2 ms", "5 ms", "10 ms"):
    place, _ = swing(skyhook, clock)
    print(f"every {clock:>5}: settled after {settled(place):.3f} s, residual {residual(place):.3f} mm")

# %%
constant = [name for name in laws if name != "skyhook"]
assert residual(places["skyhook"]) < 0.5 * min(residual(places[name]) for name in constant)
assert settled(places["skyhook"]) < 0.8 * min(settled(places[name]) for name in constant)
assert abs(places["skyhook"][-1]) < 1e-6 < abs(places["2 V"][-1])
plt.show()
