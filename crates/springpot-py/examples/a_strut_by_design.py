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
# # A strut by design
#
# You learn how the order of a springpot, its coefficient and the place where it takes hold of an arm are chosen by exact gradients, so that the arm rings
# least behind a move, under a limit of the force.

# %%
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import springpot as sp

# In a notebook there is no file; its folder is the current one.
HERE = Path(__file__).resolve().parent if "__file__" in globals() else Path.cwd()
SCENARIO = HERE.parents[2] / "scenarios" / "quiet_strut.toml"

# %%
before = sp.run(SCENARIO)
design = sp.design(SCENARIO, starts=2)
after = design.run()
print(design)
print(f"{design.runs} runs, {len(design.starts)} starts")

# %% [markdown]
# ## Before and after

# %%
fig, ax = plt.subplots(figsize=(6.4, 3.6), layout="constrained")
for label, run in (("before", before), ("after", after)):
    ax.plot(run["t"], np.rad2deg(run["q.arm"]), linewidth=1.4, label=label)
ax.axvspan(0, 0.4, color="0.93", linewidth=0)
ax.set(xlabel="t, s", ylabel="angle of the arm, deg", xlim=(0, 2))
ax.set_title("The carriage moves in the shaded time", loc="left", fontsize="medium")
ax.grid(True, color="0.9", linewidth=0.6)
ax.legend(frameon=False, fontsize="small")

# %% [markdown]
# ## The way there

# %%
fig, ax = plt.subplots(figsize=(6.4, 3.0), layout="constrained")
ax.semilogy(np.rad2deg(design.steps["objective"]), ".")
ax.set(xlabel="run", ylabel="ringing, deg")
ax.grid(True, color="0.9", linewidth=0.6)

# %%
assert design.status == "converged"
assert design.objective["after"] < 0.02 * design.objective["before"]
assert design.runs < 40 * len(design.starts)
assert np.isclose(after.metrics["ringing"], design.objective["after"], rtol=1e-6)
assert after.metrics["pull"] <= 20 * (1 + 1e-6)
plt.show()
