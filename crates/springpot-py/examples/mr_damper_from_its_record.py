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
# # A magnetorheological damper from its record
#
# You learn how the numbers of a damper, and their uncertainty, follow from its force along a stroke at several commands, and how a command that no number
# has seen tells whether the law is right. The record is simulated, as its first line says: what should come out is known.

# %%
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import springpot as sp

# In a notebook there is no file; its folder is the current one.
HERE = Path(__file__).resolve().parent if "__file__" in globals() else Path.cwd()
SCENARIO = HERE.parents[2] / "scenarios" / "mr_damper.toml"
TRUTH = {"c_0a": 900, "c_0b": 1400, "alpha": 0.7, "k_0": 800, "alpha_a": 8000, "alpha_b": 40000}

# %% [markdown]
# ## The fit
#
# Six numbers begin 30 % off. The force was written down at 0, 0.75, 1.5 and 2.25 V with 5 N of noise, and the last of these is a validation: it is
# predicted, and never fitted.

# %%
found = sp.fit(SCENARIO, set={"fit.starts": 1})
print(found)

# %%
fig, axes = plt.subplots(2, 2, figsize=(7.0, 5.0), layout="constrained", sharex=True, sharey=True)
for ax, (name, columns) in zip(axes.flat, found.columns.items()):
    force = columns["force"]
    ax.plot(force["at"], force["measured"], ".", markersize=3, label="record")
    ax.plot(force["at"], force["model"], linewidth=1.2, label="law")
    ax.set_title(name, loc="left", fontsize="medium")
    ax.grid(True, color="0.9", linewidth=0.6)
axes[0, 0].legend(frameon=False, fontsize="small")
fig.supxlabel("t, s")
fig.supylabel("force, N")

# %% [markdown]
# ## What the record does not tell well
#
# A springpot stores as a spring does: a higher order, which stores less, and a stiffer spring make up for one another.

# %%
names = list(found.parameters)
correlation = found.correlation[names.index("k_0"), names.index("alpha")]
print(f"correlation of k_0 and alpha: {correlation:.2f}")
validation = found.record["data"][3]
rms = validation["rms"]["force"]
print(f"2.25 V, predicted: {rms:.1f} N rms of 5 N noise")

# %%
assert found.status == "converged" and validation["use"] == "validation"
for name, exact in TRUTH.items():
    own = found.parameters[name]
    assert abs(own.value - exact) < 3 * own.sd, name
assert correlation > 0.7
assert abs(rms - 5) < 1
assert np.isclose(found.parameters["alpha"].value, 0.7, atol=0.01)
plt.show()
