"""Runs of scenarios, their columns and their files."""

from __future__ import annotations

import contextlib
import csv
import json
import os
import pathlib
import shutil
import tempfile
import warnings as _warnings
import webbrowser
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
import numpy.typing as npt

from . import _html
from ._case import Case, Column
from ._chosen import chosen
from ._errors import RunError, SpringpotError, SpringpotWarning
from ._figure import Figure, Look, draw, drawn, with_options
from ._progress import Progress, shown
from ._scenario import Scenario
from ._springpot import Stored, Study
from ._springpot import Case as _Case
from ._springpot import export_bytes, report_page, view_page
from ._sweeps import sweeps_of
from ._tables import Metrics, Rows, swept_column

if TYPE_CHECKING:
    import matplotlib.axes
    import pandas
    import polars
    import xarray

Sweep: TypeAlias = "Mapping[str | tuple[str, ...], Any]"


class Run:
    """What a scenario led to, in memory.

    A column of the only case is ``run["strut.force"]``; those of several cases are ``run.case(k)["strut.force"]``, and ``for case in run`` goes
    through them. ``len(run)`` is the number of cases, ``"strut.force" in run`` asks for a column. Runs are equal where all their numbers are.

    >>> import springpot as sp
    >>> run = sp.run('''
    ... robot.body = [{ name = "mass", joint = { name = "x", kind = "prismatic", axis = [1, 0, 0] }, mass = 2 }]
    ... element = [{ name = "pad", joint = "x", law = "springpot", parameters = { c = 10, alpha = 0.5 } }]
    ... motion = { kind = "prescribed", joints = { x = "0.01*t" } }
    ... time = { end = 1, output_step = 0.5 }
    ... ''')
    >>> run["pad.force"].round(6)
    array([0.      , 0.079788, 0.112838])
    >>> run.units["pad.force"]
    'N'
    """

    def __init__(self, study: Study | Stored, cases: Sequence[_Case]) -> None:
        self._study = study
        units = {name: unit for name, unit, _ in study.columns[len(study.parameters) :]}
        self._cases = [Case(study, case, units) for case in cases]

    @property
    def title(self) -> str | None:
        """The title of the scenario."""
        return self._study.title

    @property
    def scenario(self) -> dict[str, Any]:
        """What was asked for, as run.json has it: the scenario's ``name`` and ``text``, and what was ``set`` and swept (``sweep``) beside it."""
        return dict(zip(("name", "text", "set", "sweep"), self._study.scenario))

    @property
    def cases(self) -> list[Case]:
        """All cases, in the order of the grid: the last sweep runs fastest."""
        return list(self._cases)

    def case(self, k: int | str | Mapping[str, Any] | None = None, /, *, name: str | None = None, **values: Any) -> Case:
        """Case number k, where −1 is the last one, the one of that name, or the one with these swept values.

        Values are named by swept paths, or by the last part of one where no other ends so: ``run.case(alpha=0.5)``,
        ``run.case({"element.strut.alpha": 0.5, "T": "40 degC"})``. They are numbers in SI units, texts with a unit, or the texts that were swept; numbers
        need to be equal but for rounding.

        Raises:
            IndexError: there is no case of that number.
            KeyError: no path, no case or several ones are meant; the message says what is there.
        """
        if isinstance(k, Mapping):
            values, k = {**k, **values}, None
        if isinstance(k, str):
            name, k = (k, None) if name is None else (name, k)
        if k is None or isinstance(k, str):
            return chosen(self._cases, {path: self.units[path] for path in self._swept}, values, name)
        if name is not None or values:
            raise TypeError("a case is chosen by its number, or by its name and swept values")
        try:
            return self._cases[k]
        except IndexError:
            count = len(self._cases)
            raise IndexError(f"there is no case {k}: the run has {_cases(count)}, {'0' if count == 1 else f'0 to {count - 1}'}") from None

    @property
    def parameters(self) -> list[str]:
        """Names of what the run is differentiated by, in the order of ``sensitivity``; of one that is not, the paths of the swept parameters."""
        return [name for name, *_ in self._study.differentiated] or self._swept

    @property
    def _swept(self) -> list[str]:
        return self._study.parameters

    @property
    def columns(self) -> list[str]:
        """Names of the columns, without those of swept parameters."""
        names = [name for name, _, _ in self._study.columns[len(self._swept) :]]
        return [name for name in names if name in self._cases[0]._held] if self._cases else names

    def sensitivity(self, column: str, parameter: str | None = None) -> Column:
        """The derivative ``(rows,)`` of a column of the only case by a parameter, or ``(rows, P)`` by all of :attr:`parameters`."""
        return self._only("sensitivity").sensitivity(column, parameter)

    def gradient(self, metric: str) -> dict[str, float]:
        """The derivatives of a metric of the only case by parameter, as gradient.csv has them; NaN where there is none."""
        return self._only("gradient").gradient(metric)

    def _only(self, what: str) -> Case:
        if len(self._cases) != 1:
            raise SpringpotError(f"the run has {len(self._cases)} cases: run.case(k).{what}(…) is of one of them")
        return self._cases[0]

    @property
    def units(self) -> dict[str, str]:
        """The SI unit of every column, swept parameters included; empty for a pure number."""
        return {name: unit for name, unit, _ in self._study.columns}

    @property
    def meanings(self) -> dict[str, str]:
        """What every column holds."""
        return {name: meaning for name, _, meaning in self._study.columns}

    def __getitem__(self, column: str) -> Column:
        """A column ``(rows,)`` of the only case."""
        if not isinstance(column, str):
            raise TypeError(f"run[…] takes the name of a column, not {column!r}; a case is run.case(k)")
        if len(self._cases) != 1:
            raise SpringpotError(f"the run has {len(self._cases)} cases: run.case(k)[{column!r}] is a column of one of them")
        return self._cases[0][column]

    def __iter__(self) -> Iterator[Case]:
        """Its cases, in the order of the grid."""
        return iter(self._cases)

    def __contains__(self, column: object) -> bool:
        """Whether it has a column of that name."""
        return column in self.columns

    def __len__(self) -> int:
        return len(self._cases)

    def __repr__(self) -> str:
        title = f" {self.title!r}" if self.title else ""
        number = sum(case._case.has_failed for case in self._cases)
        failed = f", {number} failed" if number else ""
        return f"<Run{title} of {_cases(len(self))}{failed}: {len(self.columns)} columns>"

    def _repr_html_(self) -> str:
        return _html.run(self)

    def _ipython_key_completions_(self) -> list[str]:
        return self.columns

    def __eq__(self, other: object) -> bool:
        """Whether both have the same cases, to the bit."""
        if not isinstance(other, Run):
            return NotImplemented
        return self.title == other.title and self._cases == other._cases

    def __hash__(self) -> int:
        return hash((self.title, tuple(self._cases)))

    @property
    def failures(self) -> dict[int, RunError]:
        """Why cases failed, by their index."""
        return {case.index: case.error for case in self._cases if case.error is not None}

    @property
    def metrics(self) -> Metrics:
        """The rows of metrics.csv: a sequence of dicts; ``run.metrics["name"]`` is the value of the only case, else an array ``(cases,)``."""
        rows: list[dict[str, Any]] = []
        metrics = self._study.metrics
        for case in self._cases:
            swept = case.parameters
            for (name, column, unit), value in zip(metrics, case._case.metrics):
                rows.append({**swept, "metric": name, "column": column, "value": value, "unit": unit})
        return Metrics(rows, len(self._cases))

    @property
    def events(self) -> Rows:
        """The rows of events.csv: a sequence of dicts, ``run.events["t"]`` is a column."""
        names = [*self._swept, "event", *self._study.event_columns]
        rows: list[dict[str, Any]] = []
        kept = len(self._swept)
        for case in self._cases:
            swept = case.parameters
            for cells in csv.reader(case._case.events.splitlines()):
                row: dict[str, Any] = dict(swept)
                row["event"] = cells[kept]
                row.update({name: float(cell) if cell else float("nan") for name, cell in zip(names[kept + 1 :], cells[kept + 1 :])})
                rows.append(row)
        return Rows(rows)

    @property
    def summary(self) -> Rows:
        """The rows of summary.csv: the smallest, largest and root-mean-square value of every column of every case."""
        rows: list[dict[str, Any]] = []
        for case in self._cases:
            swept = case.parameters
            for (name, unit), (low, high, rms) in zip(case._units.items(), case._case.statistics):
                rows.append({**swept, "column": name, "unit": unit, "min": low, "max": high, "rms": rms})
        return Rows(rows)

    def table(self) -> dict[str, npt.NDArray[Any]]:
        """All rows of all cases by column, swept parameters first, as results.csv has them."""
        table: dict[str, npt.NDArray[Any]] = {}
        if not self.columns:
            raise SpringpotError("the run has no rows: its sweep brought none back")
        swept = [self._study.values(case.index) for case in self._cases]
        for k, parameter in enumerate(self._swept):
            table[parameter] = np.repeat(swept_column([row[k] for row in swept]), [case._case.rows for case in self._cases])
        for column in self.columns:
            parts = [case[column] for case in self._cases]
            table[column] = parts[0] if len(parts) == 1 else np.concatenate(parts)
        return table

    def to_pandas(self) -> pandas.DataFrame:
        """All rows as a pandas frame; ``frame.attrs["units"]`` are the units."""
        import pandas

        frame = pandas.DataFrame(self.table())
        frame.attrs["units"] = self.units
        return frame

    def to_polars(self) -> polars.DataFrame:
        """All rows as a polars frame."""
        import polars

        return polars.DataFrame(self.table())

    def to_xarray(self) -> xarray.Dataset:
        """All columns as a data set of xarray, over the sweeps and time.

        A sweep is a dimension, called as the last part of its path, with the swept values as its coordinate and, where they have names, these as
        ``NAME_name``; paths that move together share one. Units and meanings are ``attrs``, metrics variables ``metric(NAME)``. Cases that have fewer rows
        (they failed, an event ended them) end in NaN; where times differ beyond that, rows are the dimension ``row`` and ``t`` is a coordinate over all.
        """
        from ._xarray import dataset

        return dataset(self)

    def save(
        self, out: str | os.PathLike[str], *, format: str | None = None, figures: bool = True
    ) -> list[str]:
        """Writes the folder that the command ``springpot run`` writes: rows (``"csv"``, ``"parquet"`` or ``"npz"``), statistics, metrics,
        events, figures and run.json. Gives the names of the files.

        ``format``: default ``"csv"``; results that were read are copied with the format that they have."""
        if isinstance(self._study, Stored):
            return _copied(self._study, pathlib.Path(out), format, figures)
        told = self._study.write(os.fspath(out), cases=[case._case for case in self._cases], format=format or "csv", figures=figures)
        _warn(told["warnings"])
        files: list[str] = told["files"]
        return files

    def view(
        self, out: str | os.PathLike[str] | None = None, *, cases: Sequence[int] = (), open: bool | None = None
    ) -> pathlib.Path:
        """Writes the page that shows the run in motion, one HTML file that needs no network, and opens it in a browser.

        ``out``: the file, default a new temporary one; ``cases``: indices, default the first twelve; ``open``: whether a browser shows it, default
        where ``out`` is left out. Gives the path of the file."""
        with self._saved(figures=False) as folder:
            html = view_page(folder, list(cases))
        return _page(html, "view", out, open)

    def report(
        self, out: str | os.PathLike[str] | None = None, *, other: Run | None = None, open: bool | None = None
    ) -> pathlib.Path:
        """Writes the page that says what the run was and what came of it, to be read and printed; with ``other``, how that run differs.

        ``out``, ``open`` and what it gives: as ``view``."""
        with self._saved(figures=other is None, name="first") as folder:
            if other is None:
                html = report_page(folder, None)
            else:
                with other._saved(figures=False, name="second") as second:
                    html = report_page(folder, second)
        return _page(html, "report", out, open)

    def export(self, file: str | os.PathLike[str], *, case: int | None = None) -> list[str]:
        """Writes a case as a file for other programs: a recording ``.mcap`` (ROS 2, Foxglove), a moving model ``.glb`` or ``.gltf`` (glTF 2.0).

        ``case``: its index, default the first that has rows. Gives what is to be known of the file, a clause each."""
        if case is None:
            case = next((case.index for case in self._cases if case._case.rows), 0)
        with self._saved(figures=False) as folder:
            data, notes = export_bytes(folder, case, file)
        pathlib.Path(file).write_bytes(data)
        return notes

    @contextlib.contextmanager
    def _saved(self, figures: bool, name: str = "run", rows: str | None = None) -> Iterator[str]:
        """Its results in a folder for a while, with rows in that format where one is wanted."""
        study = self._study
        if isinstance(study, Stored) and rows in (None, study.format):
            yield study.folder
            return
        with tempfile.TemporaryDirectory(prefix="springpot-") as place:
            folder = os.path.join(place, name)
            if isinstance(study, Stored):
                shutil.copytree(study.folder, folder, ignore=lambda _, names: [one for one in names if one not in _TEXTS])
                study.write_rows(os.path.join(folder, "results.csv"))
                yield folder
                return
            study.write(folder, cases=[case._case for case in self._cases], format="csv", figures=figures)
            yield folder

    @with_options
    def figure(
        self,
        y: str | Sequence[str],
        x: str = "t",
        *,
        where: Mapping[str, object] | None = None,
        units: Mapping[str, str] | None = None,
        title: str | None = None,
        **look: Look,
    ) -> Figure:
        """Draws columns, or statistics of them over a swept parameter, as ``springpot plot`` and the figures of a scenario are drawn.

        ``y``: columns (``*`` stands for any text), or ``"max(strut.force)"`` (min, max, mean, rms, final) and ``"metric(NAME)"`` with a swept path as ``x``.
        ``where``: values that are fixed, by path; ``units``: by column, ``{"strut.stroke": "mm"}``. All others are the keys of ``[[figure]]``: ranges as
        numbers or quantities, scales ``"linear"`` or ``"log"``, ``aspect="equal"``, ``size=("90 mm", "60 mm")``, ``legend=False`` for none, ``window`` in t.

        Raises:
            ValueError: a column, a value or an option does not fit.
            TypeError: there is no such option, or it is neither a text nor a pair.
        """
        wanted = [y] if isinstance(y, str) else list(y)
        with self._saved(figures=False, rows="csv") as folder:
            return draw(folder, wanted, x=x, where=where, units=units, title=title, look=look)

    def map(
        self,
        z: str,
        x: str,
        y: str,
        *,
        where: Mapping[str, Any] | None = None,
        unit: str | None = None,
        title: str | None = None,
        x_scale: str = "linear",
        y_scale: str = "linear",
        size: Sequence[str | float] | None = None,
    ) -> Figure:
        """Draws a number of every case over two swept values in coloured cells with a bar, as figures of the kind ``"map"`` are drawn.

        ``z``: ``"metric(NAME)"``, or a statistic such as ``"max(strut.force)"`` (min, max, mean, rms, final), in ``unit``. ``x``, ``y``: swept paths, or their
        last parts where these tell them apart. ``where``: the value of every other sweep, by path. Cells of cases that failed are empty.

        Raises:
            KeyError: no such path, column or metric.
            ValueError: paths that are swept together, a sweep that is left open, a unit or a scale that does not fit.
        """
        from ._map import drawn

        return drawn(self, z, x, y, where or {}, unit, title, (x_scale, y_scale), size)

    def figures(self) -> dict[str, Figure]:
        """The figures of the scenario, by their names, as ``springpot run`` draws them."""
        with self._saved(figures=True) as folder:
            return drawn(folder)

    def plot(
        self, y: str | Sequence[str], x: str = "t", *, cases: Sequence[int] | None = None, ax: matplotlib.axes.Axes | None = None
    ) -> matplotlib.axes.Axes:
        """Draws columns over another one with matplotlib, in the style of the figures of a scenario: a colour for each case, a dash for each column.

        ``cases``: indices, default all. Up to twelve curves are named in a legend; more have a colour bar, of the swept value where the cases differ
        by one number alone, else of the case."""
        from ._plot import plot

        return plot(self, [y] if isinstance(y, str) else list(y), x, cases, ax)


_TEXTS = ("run.json", "metrics.csv", "summary.csv", "events.csv")
"""What a figure of results needs beside their rows."""


def _copied(study: Stored, out: pathlib.Path, format: str | None, figures: bool) -> list[str]:
    """The files of results that were read, in another folder."""
    if format not in (None, study.format):
        raise ValueError(f"the rows of {study.folder} are {study.format!r}: results that were read are copied as they are, not as {format!r}")
    if out.exists() and any(out.iterdir()):
        raise SpringpotError(f"{out} is not empty: results that were read are copied into a new folder")
    with open(os.path.join(study.folder, "run.json"), encoding="utf-8") as record:
        files = [name for name in json.load(record)["files"] if figures or not name.startswith("figures/")]
    for name in files:
        (out / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(os.path.join(study.folder, name), out / name)
    return files


def _page(html: str, name: str, out: str | os.PathLike[str] | None, show: bool | None) -> pathlib.Path:
    """Writes a page, and shows it where that is wanted."""
    if out is None:
        # It stays: a browser may read it any time.
        path = pathlib.Path(tempfile.mkdtemp(prefix="springpot-")) / f"{name}.html"
    else:
        path = pathlib.Path(out)
    path.write_text(html, encoding="utf-8")
    if show if show is not None else out is None:
        webbrowser.open(path.resolve().as_uri())
    return path


def run(
    scenario: Scenario,
    set: Mapping[str, Any] | None = None,
    sweep: Sweep | None = None,
    out: str | os.PathLike[str] | None = None,
    jobs: int | None = None,
    progress: Progress = None,
    *,
    format: str = "csv",
    figures: bool = True,
    sensitivity: str | Sequence[str] | None = None,
) -> Run:
    """Runs a scenario, all cases of its sweeps on all cores, without the GIL.

    Args:
        scenario: a path, a text (a ``str`` with a line break or ``=``), or a dict.
        set: values by path, ``{"element.strut.alpha": 0.5, "element.strut.T": "40 degC"}``.
        sweep: sequences by path, ``{"element.strut.alpha": [0.2, 0.5]}``; several paths make a grid, a tuple of paths moves together:
            ``{("element.a.k", "element.b.k"): [(1, 2), (3, 4)]}``. It replaces the scenario's sweep of that path or adds one.
        out: a folder that is written as by ``springpot run``; nothing is written without it.
        jobs: cases at a time, default all cores.
        progress: ``True`` for a bar (tqdm where it is installed), or a callable that is told the share that is done, 0 … 1.
        format: of the rows in ``out``: ``"csv"``, ``"parquet"`` or ``"npz"``.
        figures: whether the scenario's figures are drawn into ``out``.
        sensitivity: paths of numbers, or names of parameters, by which every column is differentiated besides those of the scenario:
            ``run["d(q.q2)/d(element.strut.alpha)"]``.

    Raises:
        ScenarioError: the scenario is refused.
        RunError: its only case fails; in a sweep ``Run.failures`` has them.
    """
    asked = [sensitivity] if isinstance(sensitivity, str) else list(sensitivity or [])
    study = Study(scenario, set, sweeps_of(sweep), asked)
    _warn(study.warnings)
    with shown(progress) as told:
        if out is None:
            cases = study.cases(list(range(len(study))), jobs=_jobs(jobs), progress=told)
        else:
            answer = study.write(os.fspath(out), jobs=_jobs(jobs), format=format, figures=figures, progress=told)
            _warn(answer["warnings"])
            cases = answer["cases"]
    return checked(Run(study, cases))


def checked(run: Run) -> Run:
    """The run; a failure of its only case is raised."""
    if len(run) == 1 and (error := run.case(0).error) is not None:
        raise error
    return run


def _jobs(jobs: int | None) -> int:
    if jobs is None:
        return 0
    if isinstance(jobs, bool) or not isinstance(jobs, int) or jobs < 1:
        raise ValueError(f"jobs is {jobs!r}; write a number of cases at a time from 1 on, or leave it out for all cores")
    return jobs


def _warn(warnings: Sequence[tuple[str, str | None]]) -> None:
    for message, help in warnings:
        _warnings.warn(f"{message}; {help}" if help else message, SpringpotWarning, stacklevel=3)


def _cases(count: int) -> str:
    return "1 case" if count == 1 else f"{count} cases"
