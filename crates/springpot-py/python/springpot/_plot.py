"""Figures in the style of the house, on matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import matplotlib.axes

    from ._run import Run

DASHES = ("-", "--", ":", "-.")
NAMED = 12


def plot(
    run: Run, y: Sequence[str], x: str, cases: Sequence[int] | None, ax: matplotlib.axes.Axes | None
) -> matplotlib.axes.Axes:
    """Colour for the case, dash for the column."""
    import matplotlib.pyplot as plt

    chosen = [run.case(k) for k in (range(len(run)) if cases is None else cases)]
    if ax is None:
        _, ax = plt.subplots(figsize=(5.9, 3.6), layout="constrained")
    colours = plt.get_cmap("viridis")
    names = [name for name, _, _ in run._study.columns]
    label = {column: run._study.axis(names.index(column)) for column in (x, *y) if column in names}
    for place, case in enumerate(chosen):
        colour = "C0" if len(chosen) == 1 else colours(0.9 * place / max(len(chosen) - 1, 1))
        for k, column in enumerate(y):
            words = [run._study.name(case.index)] if len(chosen) > 1 else []
            words += [label.get(column, column)] if len(y) > 1 else []
            ax.plot(
                case[x],
                case[column],
                DASHES[k % len(DASHES)],
                color=colour if len(chosen) > 1 or len(y) == 1 else f"C{k}",
                linewidth=1.4,
                label=", ".join(words) or None,
            )
    ax.set_xlabel(label.get(x, x))
    ax.set_ylabel(label.get(y[0], y[0]) if len(y) == 1 else _shared(run, y))
    ax.set_title(run.title or "", loc="left", fontsize="medium")
    ax.grid(True, color="0.9", linewidth=0.6)
    ax.spines[["top", "right"]].set_visible(False)
    if 1 < len(chosen) * len(y) <= NAMED:
        ax.legend(frameon=False, fontsize="small")
    return ax


def _shared(run: Run, y: Sequence[str]) -> str:
    units = {run.units[column] for column in y}
    return units.pop() if len(units) == 1 else ""
