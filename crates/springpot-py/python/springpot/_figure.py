"""Figures as the command draws them."""

from __future__ import annotations

import inspect
import os
import pathlib
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias, TypeVar

from ._springpot import look_options, plot_figure

Look: TypeAlias = "str | bool | Sequence[float | str] | Mapping[str, str] | None"
"""What an option of the look of a figure may be."""

OPTIONS = dict(look_options())
"""Options of the look of a figure, and what they say."""

Method = TypeVar("Method", bound="Callable[..., Any]")


def with_options(method: Method) -> Method:
    """The same method, in whose signature the options of a look stand one by one, for help and completion."""
    own = inspect.signature(method)
    named = [parameter for parameter in own.parameters.values() if parameter.kind is not parameter.VAR_KEYWORD]
    options = [inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation="Look") for name in OPTIONS]
    method.__signature__ = own.replace(parameters=[*named, *options])  # type: ignore[attr-defined]
    return method


@dataclass(frozen=True)
class Figure:
    """A figure in all formats; a notebook shows it."""

    svg: str
    """The figure as an SVG document."""
    png: bytes
    """As a PNG file, 240 dpi."""
    pdf: bytes
    """As a PDF file of one page, with its font inside; empty where it was not drawn as one."""
    remarks: tuple[str, ...] = ()
    """What it does not show, a clause each."""

    def save(self, file: str | os.PathLike[str]) -> pathlib.Path:
        """Writes ``.svg``, ``.png`` or ``.pdf``, by the ending of the name."""
        path = pathlib.Path(file)
        found: dict[str, bytes] = {".svg": self.svg.encode(), ".png": self.png, ".pdf": self.pdf}
        if not found.get(path.suffix.lower()):
            raise ValueError(f"{path}: a figure is saved as {', '.join(ending for ending, data in found.items() if data)}")
        path.write_bytes(found[path.suffix.lower()])
        return path

    def __repr__(self) -> str:
        size = re.search(r'<svg [^>]*?viewBox="0 0 ([\d.]+) ([\d.]+)"', self.svg)
        drawn = f"{float(size[1]):.0f} x {float(size[2]):.0f} pt" if size else "empty"
        return f"<Figure: {drawn}{''.join(f'; {remark}' for remark in self.remarks)}>"

    def _repr_svg_(self) -> str:
        return self.svg


def draw(
    folder: str,
    y: Sequence[str],
    *,
    x: str,
    where: Mapping[str, object] | None,
    units: Mapping[str, str] | None,
    title: str | None,
    look: Mapping[str, Look],
) -> Figure:
    """The figure of the results in a folder, with options of the look by their names."""
    selection = [f"{path}={value}" for path, value in (where or {}).items()]
    drawn_in = [f"{column}={unit}" for column, unit in (units or {}).items()]
    asked = [one for name, value in look.items() for one in _option(name, value)]
    svg, png, pdf, remarks = plot_figure(folder, list(y), x, selection, drawn_in, title, asked)
    return Figure(svg, bytes(png), bytes(pdf), tuple(remarks))


def _option(name: str, value: object) -> list[tuple[str, str | None]]:
    """An option of a look as texts."""
    if name not in OPTIONS:
        raise TypeError(f"figures have no option {name!r}; there are {', '.join(OPTIONS)}")
    if value is None or value is True:
        return []
    if value is False:
        return [(name, None)]
    if isinstance(value, Mapping):
        return [(name, f"{column}={text}") for column, text in value.items()]
    if isinstance(value, str):
        return [(name, value)]
    if isinstance(value, Sequence):
        return [(name, ",".join(str(part) for part in value))]
    raise TypeError(f"{name} = {value!r}: a text or a pair is wanted")


def drawn(folder: str) -> dict[str, Figure]:
    """The figures that a run drew in a folder, by their names."""
    figures: dict[str, dict[str, bytes]] = {}
    for file in sorted(pathlib.Path(folder, "figures").glob("*")):
        figures.setdefault(file.stem, {})[file.suffix] = file.read_bytes()
    return {
        name: Figure(data.get(".svg", b"").decode(), data.get(".png", b""), data.get(".pdf", b"")) for name, data in figures.items()
    }
