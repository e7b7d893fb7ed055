"""Figures in the style of the house, on matplotlib."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import matplotlib.axes

    from ._run import Case, Run

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
    colours = plt.get_cmap("plasma")
    names = [name for name, _, _ in run._study.columns]
    label = {column: run._study.axis(names.index(column)) for column in (x, *y) if column in names}
    title, cases_called = _called(run, chosen)
    for place, case in enumerate(chosen):
        colour = "C0" if len(chosen) == 1 else colours(0.02 + 0.83 * place / max(len(chosen) - 1, 1))
        for k, column in enumerate(y):
            words = [cases_called[place]] if len(chosen) > 1 else []
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
    ax.set_title(run.title or "", fontsize="medium")
    ax.margins(x=0.0 if x == "t" else 0.03)
    ax.grid(True, color="0.9", linewidth=0.6)
    ax.spines[["top", "right"]].set_visible(False)
    if 1 < len(chosen) * len(y) <= NAMED:
        # Beside the curves: there is no room among them.
        ax.legend(title=title, frameon=False, fontsize="small", title_fontsize="small", loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return ax


def _called(run: Run, chosen: Sequence[Case]) -> tuple[str | None, list[str]]:
    """What stands above the legend, and what the cases are called: by what they differ in alone."""
    paths = run.parameters
    names = [run._study.name(case.index) for case in chosen]
    read = [re.fullmatch(", ".join(f"{re.escape(path)} = (.*)" for path in paths), name, re.DOTALL) for name in names]
    values = [found.groups() for found in read if found is not None]
    if len(values) != len(names) or not paths:
        return None, names
    varied = [k for k in range(len(paths)) if len({row[k] for row in values}) > 1]
    short = [paths[k].rpartition(".")[2].replace("alpha", "α") for k in varied]
    if len(varied) == 1:
        return short[0], [row[varied[0]] for row in values]
    return None, [", ".join(f"{name} = {row[k]}" for name, k in zip(short, varied)) for row in values]


def _shared(run: Run, y: Sequence[str]) -> str:
    units = {run.units[column] for column in y}
    return units.pop() if len(units) == 1 else ""
