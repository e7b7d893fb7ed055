"""Figures in the style of the house, on matplotlib."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import matplotlib.axes

    from ._case import Case
    from ._run import Run

DASHES: tuple[Any, ...] = ("-", "--", ":", "-.")
NAMED = 12
"""Curves that a legend names, at most."""
WIDE = 100.0
"""Swept values that are further apart than this by factors have a logarithmic colour bar."""


def plot(
    run: Run, y: Sequence[str], x: str, cases: Sequence[int] | None, ax: matplotlib.axes.Axes | None
) -> matplotlib.axes.Axes:
    """Colour for the case, dash for the column."""
    import matplotlib.pyplot as plt
    from matplotlib.lines import Line2D

    chosen = [run.case(k) for k in (range(len(run)) if cases is None else cases)]
    if ax is None:
        _, ax = plt.subplots(figsize=(5.9, 3.6), layout="constrained")
    colours = plt.get_cmap("plasma")
    many = len(chosen) * len(y) > NAMED and len(chosen) > 1
    bar = _bar(run, chosen, colours) if many else None
    names = [name for name, _, _ in run._study.columns]
    label = {column: run._study.axis(names.index(column)) for column in (x, *y) if column in names}
    title, cases_called = _called(run, chosen)
    for place, case in enumerate(chosen):
        if bar is None:
            colour = "C0" if len(chosen) == 1 else colours(0.02 + 0.83 * place / max(len(chosen) - 1, 1))
        else:
            colour = bar[0].to_rgba(bar[1][place])
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
    if bar is not None:
        ax.figure.colorbar(bar[0], ax=ax, label=bar[2])
        if len(y) > 1:
            handles = [Line2D([], [], color="0.3", linestyle=DASHES[k % len(DASHES)]) for k in range(len(y))]
            ax.legend(handles, [label.get(column, column) for column in y], frameon=False, fontsize="small")
    elif 1 < len(chosen) * len(y) <= NAMED:
        # Beside the curves: there is no room among them.
        ax.legend(title=title, frameon=False, fontsize="small", title_fontsize="small", loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return ax


def _bar(run: Run, chosen: Sequence[Case], colours: Any) -> tuple[Any, list[float], str]:
    """The colours of a bar, where each case stands on it, and what it shows: the value by which cases differ, or their index."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap, LogNorm, Normalize

    # The brightest end is hard to see on white.
    shown = ListedColormap(colours(np.linspace(0.02, 0.85, 256)))
    parameters = [case.parameters for case in chosen]
    varied = [path for path in run._swept if len({row[path] for row in parameters}) > 1]
    read = [row[varied[0]] for row in parameters] if len(varied) == 1 else []
    values = [value for value in read if not isinstance(value, str)]
    if not values or len(values) < len(read):
        values, label = [float(case.index) for case in chosen], "case"
    else:
        label = run._study.axis(run._swept.index(varied[0]))
    low, high = min(values), max(values)
    norm = LogNorm(low, high) if label != "case" and low > 0 and high > WIDE * low else Normalize(low, high)
    return ScalarMappable(norm, shown), values, label


def _called(run: Run, chosen: Sequence[Case]) -> tuple[str | None, list[str]]:
    """What stands above the legend, and what the cases are called: by what they differ in alone."""
    paths = run._swept
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
