"""What notebooks show: small tables, without scripts and without styles of their own."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ._case import Case
    from ._run import Run
    from ._springpot import Law, Model, Prony
    from ._tables import Rows

MOST_ROWS = 20
"""Of a table; what is left out is counted below it."""


def table(caption: str, head: Sequence[str], rows: Iterable[Sequence[Any]], count: int | None = None) -> str:
    """A table of texts and numbers, the first ``MOST_ROWS`` of ``count`` rows."""
    listed = [row for row, _ in zip(rows, range(MOST_ROWS))]
    left = (len(listed) if count is None else count) - len(listed)
    title = "".join(f"<th>{escape(word)}</th>" for word in head)
    body = "".join("<tr>" + "".join(_cell(value) for value in row) + "</tr>" for row in listed)
    more = f'<tr><td colspan="{len(head)}">… and {left} more</td></tr>' if left > 0 else ""
    above = f"<thead><tr>{title}</tr></thead>" if head else ""
    return f"<table><caption>{escape(caption)}</caption>{above}<tbody>{body}{more}</tbody></table>"


def _cell(value: Any) -> str:
    return f"<td>{escape(number(value) if isinstance(value, (float, np.floating)) else str(value))}</td>"


def number(value: float | np.floating[Any]) -> str:
    """Six digits, nothing where there is no value."""
    return "" if np.isnan(value) else f"{value:.6g}"


def _listed(values: Mapping[str, Any]) -> str:
    return ", ".join(f"{name} = {number(value) if isinstance(value, float) else value}" for name, value in values.items())


def case(of: Case) -> str:
    """The ranges of its columns, or why it failed."""
    name = _listed(of.parameters)
    caption = f"Case {of.index}{': ' if name else ''}{name}, {of.rows} rows"
    if of.error is not None:
        caption += f"; failed: {of.error}"
    statistics = zip(of.units.items(), of.statistics)
    return table(caption, ["column", "unit", "min", "max", "rms"], ((name, unit, *some) for (name, unit), some in statistics), len(of.units))


def run(of: Run) -> str:
    """Its only case, or all of them."""
    title = f"{of.title}: " if of.title else ""
    if len(of) == 1:
        return case(of.case(0)).replace("<caption>", f"<caption>{escape(title)}", 1)
    failed = f", {len(of.failures)} failed" if of.failures else ""
    head = ["case", *of._swept, "rows", "failed"]

    def row(one: Case) -> list[Any]:
        return [one.index, *one.parameters.values(), one.rows, "" if one.error is None else str(one.error).splitlines()[0]]

    return table(f"{title}{len(of)} cases{failed}, {len(of.columns)} columns", head, map(row, of.cases), len(of))


def rows(of: Rows) -> str:
    """Its rows."""
    names = list(dict.fromkeys(name for row in of for name in row))
    return table(f"{len(of)} rows", names, ([row.get(name, "") for name in names] for row in of), len(of))


def law(of: Law) -> str:
    """Its parameters."""
    units = of.units
    values = ((name, _value(value), units[name]) for name, value in of.parameters.items())
    called = of.equation if of.equation == of.name else f"{of.name}: {of.equation}"
    return table(f"{called}; derivative: {of.derivative}", ["parameter", "value", "unit"], values)


def _value(value: Any) -> Any:
    if isinstance(value, tuple):
        return f"{len(value[0])} points"
    return ", ".join(number(one) for one in value) if isinstance(value, list) else value


def model(of: Model) -> str:
    """Its bodies, and how many joints they have."""
    name = f"{of.name}: " if of.name else ""
    caption = f"{name}{len(of.joint_names)} joints, nq = {of.nq}, nv = {of.nv}, {number(of.mass)} kg"
    rows = zip(of.body_names, of.body_parents, of.masses)
    return table(caption, ["body", "carried by", "mass, kg"], rows, len(of.body_names))


def prony(of: Prony) -> str:
    """Its branches."""
    caption = f"{len(of)} branches, equilibrium {number(of.equilibrium)}, error {of.error:.1e}"
    return table(caption, ["modulus", "time, s"], zip(of.moduli, of.times), len(of))
