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
# # A UR5 and its mount, from a record of the whole arm
#
# You learn how numbers of an element are found where nobody can measure it alone: from the angle of a joint and a force while the robot moves. Where the
# joint stood at the start and the zero of the force are not known, and found as well. The record is simulated, with noise and seed in its first lines.

# %%
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import springpot as sp

# In a notebook there is no file; its folder is the current one.
HERE = Path(__file__).resolve().parent if "__file__" in globals() else Path.cwd()
SCENARIO = HERE.parents[2] / "scenarios" / "ur5_mount.toml"
TRUTH = {
    "k": 20e3,
    "c": 2.8e3,
    "alpha": 0.33,
    "rest_length": 0.194,
    "record.motion.start.q.elbow_joint": np.deg2rad(100.3),
    "record.offset.mount.force": 12.0,
}

# %% [markdown]
# ## The fit
#
# The shoulder swings for two seconds, and the elbow hangs in its rubber. k, c and alpha begin 30 % off. Runs are differentiated exactly, so that each step
# costs two runs, however many numbers are sought.

# %%
found = sp.fit(SCENARIO, set={"fit.starts": 1})
print(found)

# %%
elbow, force = (found.columns["record"][column] for column in ("q.elbow_joint", "mount.force"))
fig, axes = plt.subplots(3, 1, figsize=(6.4, 6.4), layout="constrained", sharex=True)
axes[0].plot(elbow["at"], np.rad2deg(elbow["measured"]), ".", markersize=3, label="record")
axes[0].plot(elbow["at"], np.rad2deg(elbow["model"]), linewidth=1.2, label="run")
axes[0].set_ylabel("elbow, deg")
axes[0].legend(frameon=False, fontsize="small")
axes[1].plot(force["at"], force["measured"], ".", markersize=3)
axes[1].plot(force["at"], force["model"], linewidth=1.2)
axes[1].set_ylabel("force, N")
axes[2].plot(elbow["at"], elbow["residual"], ".", markersize=3)
axes[2].set(xlabel="t, s", ylabel="residual of the elbow, sd")
for ax in axes:
    ax.grid(True, color="0.9", linewidth=0.6)

# %% [markdown]
# ## Is it right?
#
# Residuals are of the size of the noise, and do not follow one another: the law says all that the record does.

# %%
for name, exact in TRUTH.items():
    own = found.parameters[name]
    print(f"{name:34} {own.value:10.5g} ± {own.sd:.2g} {own.unit}, {(own.value - exact) / own.sd:+.1f} sd off")
lag = max(found.record["lag1"].values())
share = found.record["cost"] / (found.record["n"] - found.record["p"])

# %%
assert found.status == "converged"
for name, exact in TRUTH.items():
    own = found.parameters[name]
    assert abs(own.value - exact) < 3 * own.sd, name
assert 0.7 < share < 1.2 and lag < 0.2
assert not found.undetermined
plt.show()
