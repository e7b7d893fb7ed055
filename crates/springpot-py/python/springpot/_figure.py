"""Figures as the command draws them."""

from __future__ import annotations

import os
import pathlib
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from ._springpot import plot_figure

Range: TypeAlias = "Sequence[float | str]"


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
    look: Mapping[str, object],
    legend: str | bool | None,
) -> Figure:
    """The figure of the results in a folder, by the options of ``springpot plot``."""
    arguments = [folder, *y, f"--x={x}"]
    arguments += [f"--where={path}={value}" for path, value in (where or {}).items()]
    arguments += [f"--unit={column}={unit}" for column, unit in (units or {}).items()]
    if title is not None:
        arguments.append(f"--title={title}")
    for name, value in look.items():
        if value is None:
            continue
        option = name.replace("_", "-")
        if isinstance(value, Mapping):
            arguments += [f"--label={column}={text}" for column, text in value.items()]
        elif isinstance(value, str):
            arguments.append(f"--{option}={value}")
        elif isinstance(value, Sequence):
            arguments.append(f"--{option}={','.join(str(part) for part in value)}")
        else:
            raise TypeError(f"{name} = {value!r}: a text or a pair is wanted")
    if legend is False:
        arguments.append("--no-legend")
    elif isinstance(legend, str):
        arguments.append(f"--legend={legend}")
    svg, png, pdf, remarks = plot_figure(arguments)
    return Figure(svg, bytes(png), bytes(pdf), tuple(remarks))


def drawn(folder: str) -> dict[str, Figure]:
    """The figures that a run drew in a folder, by their names."""
    figures: dict[str, dict[str, bytes]] = {}
    for file in sorted(pathlib.Path(folder, "figures").glob("*")):
        figures.setdefault(file.stem, {})[file.suffix] = file.read_bytes()
    return {
        name: Figure(data.get(".svg", b"").decode(), data.get(".png", b""), data.get(".pdf", b"")) for name, data in figures.items()
    }
