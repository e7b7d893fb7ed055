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
# # The half derivative of my data
#
# You learn how to differentiate samples half a time, what noise does to the result, and how to get the samples back. You also learn how a Prony series
# of exponentials, which every finite-element code knows, stands for the same operator, and how well.

# %%
import matplotlib.pyplot as plt
import numpy as np
from scipy.signal import savgol_filter

import springpot as sp

# %% [markdown]
# ## Samples
#
# Three seconds at 1 kHz of a motion that begins at rest. Yours: `t, x = np.loadtxt("mine.csv", delimiter=",", skiprows=1, unpack=True)`. The exact
# half derivative of these is a Mittag-Leffler function: D^½ e^(λt) = λ √t E_{1,3/2}(λt) with the lower terminal 0 (Caputo).


# %%
def samples(count):
    """Times, s, samples, mm, and their exact half derivative, mm/√s."""
    t = np.linspace(0, 3, count)
    x, exact = np.zeros(count), np.zeros(count)
    for size, hertz in [(1.0, 1.0), (0.2, 4.0)]:
        rate = 2j * np.pi * hertz
        x += size * (1 - np.exp(rate * t).real)
        exact -= size * (rate * np.sqrt(t) * sp.fractional.mittag_leffler(rate * t, 1.0, 1.5)).real
    return t, x, exact


t, x, exact = samples(3001)
half = sp.fractional.derivative(t, x, 0.5)
whole = sp.fractional.derivative(t, x, 1.0)
size = np.abs(exact).max()
print(f"D^½ of clean samples: off by {np.abs(half - exact).max() / size:.1e} of its largest value")

fig, ax = plt.subplots(figsize=(5.9, 3.6), layout="constrained")
for values, label in [(x, "x, mm"), (half, "D^½ x, mm/√s"), (whole / 5, "x'/5, mm/s")]:
    ax.plot(t, values, linewidth=1.4, label=label)
ax.set(xlabel="t, s")
ax.set_title("Half way from a place to a speed", loc="left", fontsize="medium")
ax.grid(True, color="0.9", linewidth=0.6)
ax.legend(frameon=False, fontsize="small")

# %% [markdown]
# ## How good is it?
#
# Between the samples `"spline"` takes a smooth curve, the schemes of the literature straight lines or steps. `with_error=True` estimates the error
# where nothing exact is known.

# %%
counts = [76, 151, 301, 601, 1201]
fig, ax = plt.subplots(figsize=(5.9, 3.6), layout="constrained")
for method in ("grunwald-letnikov", "l1", "spline"):
    errors = []
    for count in counts:
        few, sampled, known = samples(count)
        errors.append(np.abs(sp.fractional.derivative(few, sampled, 0.5, method=method) - known).max() / size)
    ax.loglog([3e3 / (count - 1) for count in counts], errors, "o-", markersize=3, linewidth=1.4, label=method)
ax.set(xlabel="between two samples, ms", ylabel="largest error, relative")
ax.set_xticks([2.5, 5, 10, 20, 40], labels=["2.5", "5", "10", "20", "40"])
ax.minorticks_off()
ax.set_title("Error of D^½ of clean samples", loc="left", fontsize="medium")
ax.grid(True, color="0.9", linewidth=0.6)
ax.legend(frameon=False, fontsize="small")
few, sampled, known = samples(301)
value, estimate = sp.fractional.derivative(few, sampled, 0.5, with_error=True)
print(f"at 100 Hz: error {np.abs(value - known).max():.1e}, estimated {estimate.max():.1e} mm/√s")

# %% [markdown]
# ## Noise
#
# White noise of σ becomes noise of about 1.1·σ/√h in D^½, h the time between two samples: faster sampling makes it worse, though less so than for x',
# where it is σ/h, and worst in the last samples. So smooth first, over a time that is short against the motion.

# %%
sigma, h = 1e-3, t[1] - t[0]
noisy = x + sigma * np.random.default_rng(1).standard_normal(t.size)
smooth = savgol_filter(noisy, 101, 5)
of_noisy, of_smooth = sp.fractional.derivative(t, noisy, 0.5), sp.fractional.derivative(t, smooth, 0.5)
raw, left = np.std(of_noisy - exact), np.std(of_smooth - exact)
print(f"noise of 1 µm: {raw:.4f} mm/√s in D^½, σ/√h = {sigma / np.sqrt(h):.4f}; after smoothing {left:.4f}")

fig, ax = plt.subplots(figsize=(5.9, 3.6), layout="constrained")
ax.plot(t, of_noisy - exact, linewidth=0.6, color="0.7", label="of the noisy samples")
ax.plot(t, of_smooth - exact, linewidth=1.4, label="of the smoothed ones")
ax.set(xlabel="t, s", ylabel="error of D^½ x, mm/√s")
ax.set_title("What 1 µm of noise does", loc="left", fontsize="medium")
ax.grid(True, color="0.9", linewidth=0.6)
ax.legend(frameon=False, fontsize="small")

# %% [markdown]
# ## There and back
#
# The order −½ integrates half a time: I^½ D^½ x = x − x(0).

# %%
back = sp.fractional.derivative(t, half, -0.5)
back_of_noisy = sp.fractional.derivative(t, of_noisy, -0.5)
round_trip = np.abs(back - (x - x[0])).max() / np.ptp(x)
print(f"clean samples come back to {round_trip:.1e} of their range")
print(f"noisy ones to {np.abs(back_of_noisy - (noisy - noisy[0])).max():.1e} mm")

# %% [markdown]
# ## A Prony series of it
#
# A springpot with c = 1 *is* D^½. The shortest sum of exponentials that stands for it from 0.05 to 50 Hz has ten terms; each is one number that is
# carried along, z' = x' − z/τ, and D^½ x ≈ Σ m z. That is how codes without fractional orders can have it.

# %%
springpot = sp.law("springpot", c=1.0, alpha=0.5)
series = sp.prony(springpot, band=("0.05 Hz", "50 Hz"), rtol=1e-3)
print(series)


def by_series(series, t, x):
    """Σ m z at the samples, exact for straight lines between them."""
    step = t[1] - t[0]
    decay = np.exp(-step / series.times)
    z, values = np.zeros(len(series)), [0.0]
    for dx in np.diff(x):
        z = decay * z + series.times * (1 - decay) * dx / step
        values.append(series.moduli @ z)
    return np.array(values) + series.equilibrium * (x - x[0])


ten = by_series(series, t, x)
by_ten = np.abs(ten - exact).max() / size
print(f"D^½ of the clean samples by {len(series)} exponentials: off by {by_ten:.1e}")

fig, (left_ax, right_ax) = plt.subplots(1, 2, figsize=(9.5, 3.6), layout="constrained")
omega = 2 * np.pi * np.geomspace(0.005, 500, 400)
wanted = springpot.modulus(omega)
left_ax.loglog(omega / (2 * np.pi), np.abs(series.modulus(omega) / wanted - 1), linewidth=1.4)
left_ax.axhline(1e-3, color="0.6", linewidth=0.8)
left_ax.axvspan(0.05, 50, color="0.95")
left_ax.set(xlabel="frequency, Hz", ylabel="error of the modulus, relative")
left_ax.set_title("Kept between 0.05 and 50 Hz", loc="left", fontsize="medium")
right_ax.semilogx(series.times, series.moduli, "o", markersize=4)
right_ax.set(xlabel="time τ, s", ylabel="modulus m, N/m", yscale="log")
right_ax.set_title("The terms of the series", loc="left", fontsize="medium")
for ax in (left_ax, right_ax):
    ax.grid(True, color="0.9", linewidth=0.6)

# %% [markdown]
# The way back: a law fitted to the modulus of the series is the springpot again.

# %%
measured = 2 * np.pi * np.geomspace(0.1, 30, 60)
law, deviation, spread = sp.fit(measured, series.modulus(measured), law="springpot")
print(law, f"to {deviation:.1e}")

# %%
assert np.abs(half - exact).max() < 1e-9 * size
assert 0.9 < raw / (sigma / np.sqrt(h)) < 1.3 and left < 0.2 * raw
assert round_trip < 1e-4
assert series.error <= 1e-3 and by_ten < 1e-3
assert abs(law.parameters["alpha"] - 0.5) < 1e-3 and abs(law.parameters["c"] - 1) < 1e-3
plt.show()
