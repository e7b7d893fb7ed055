"""Sweeps on other people's workers: Dask, Ray, concurrent.futures, MPI, or whatever takes tasks by ``submit``."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Mapping, Sequence
from fnmatch import fnmatchcase
from functools import lru_cache
from typing import Any, Protocol

from ._errors import RunError, SpringpotError
from ._futures import Came, Executed, Failed, Remote, Scheduler
from ._progress import Progress, shown
from ._ray import RayClient, is_ray
from ._run import Run, Sweep, _jobs, _warn, checked, run
from ._scenario import Scenario
from ._springpot import Case, Study
from ._sweeps import sweeps_of
from ._tables import unknown

PATIENCE = 0.1
"""How long a look at a worker takes at most, s."""

AHEAD = 4
"""Tasks for every worker that are under way or wait to be fetched: what bounds memory where the first ones are late."""

MOST_IN_TASK = 64
TASKS_PER_WORKER = 16


class Future(Protocol):
    """What ``submit`` returns."""

    def result(self, timeout: float | None = None) -> Any: ...


class Client(Protocol):
    """A Dask ``Client``, a ``concurrent.futures.Executor``, ``mpi4py.futures.MPIPoolExecutor``, or anything that looks so."""

    def submit(self, work: Any, /, *args: Any, **kwargs: Any) -> Any: ...


@lru_cache(maxsize=4)
def _study(payload: bytes) -> Study:
    return Study.from_bytes(payload)


def work(payload: bytes, indices: Sequence[int], kept: list[int] | None = None) -> list[bytes]:
    """Runs cases in a worker; of their columns all come back, or those in these places alone."""
    cases = _study(payload).cases(list(indices), jobs=1)
    return [(case if kept is None else case.with_columns(kept)).to_bytes() for case in cases]


class Gathering:
    """Cases of a study from the workers of a client, asked for in order."""

    def __init__(self, study: Study, client: Client, chunk: int | None, retries: int, kept: list[int] | None = None) -> None:
        # What work takes beside the study and the cases.
        self._more: tuple[Any, ...] = () if kept is None else (kept,)
        self._client, self._retries = client, retries
        self._payload, self._count = study.to_bytes(), len(study)
        workers = _workers(client)
        shared = -(-self._count // (workers * TASKS_PER_WORKER))
        self._chunk = chunk if chunk is not None else max(1, min(MOST_IN_TASK, shared))
        self._ahead = max(2, AHEAD * workers)
        self._tasks: dict[int, Executed | Remote] = {}
        self._tries: dict[int, int] = {}
        self._found: dict[int, Case] = {}
        self._scheduler = Scheduler(client) if _is_dask(client) else None
        # Dask knows work by what it is given: a case that is asked for again is to run again.
        self._words = {"pure": False} if self._scheduler is not None else {}

    def get(self, index: int, patience: float | None = None) -> Case | None:
        """The case, or ``None`` where it has not come within so many seconds."""
        task = index // self._chunk
        if index not in self._found:
            for ahead in range(task, min(task + self._ahead, -(-self._count // self._chunk))):
                if ahead not in self._tasks and ahead * self._chunk not in self._found:
                    self._submit(ahead)
            outcome = self._tasks[task].look(patience)
            if outcome is None:
                return None
            if isinstance(outcome, Came):
                self._found.update(zip(self._indices(task), self._cases(task, outcome.value)))
                del self._tasks[task]
            elif isinstance(outcome, Failed):
                self._again(task, outcome.error)
                return None
            else:
                self._submit(task)
                return None
        return self._found.pop(index)

    def _indices(self, task: int) -> range:
        start = task * self._chunk
        return range(start, min(start + self._chunk, self._count))

    def _called(self, task: int) -> str:
        cases = self._indices(task)
        return f"case {cases.start}" if len(cases) == 1 else f"cases {cases.start} to {cases.stop - 1}"

    def _cases(self, task: int, value: Any) -> list[Case]:
        """What :func:`work` gave, and not what something else did."""
        wanted = self._indices(task)
        if not isinstance(value, list) or len(value) != len(wanted):
            count = f" of {len(value)}" if isinstance(value, list) else ""
            raise RunError(f"{self._called(task)}: the client gave {type(value).__name__}{count} in place of what work(…) returns")
        try:
            cases = [Case.from_bytes(bytes) for bytes in value]
        except (TypeError, ValueError) as error:
            raise RunError(f"{self._called(task)}: the client gave something else than what work(…) returns: {error}") from error
        for index, case in zip(wanted, cases):
            if case.index != index:
                raise RunError(f"{self._called(task)}: the client gave case {case.index} in place of case {index}")
        return cases

    def _submit(self, task: int) -> None:
        try:
            future = self._client.submit(work, self._payload, list(self._indices(task)), *self._more, **self._words)
        except Exception as error:
            raise RunError(f"the client takes no more work: {error}") from error
        self._tasks[task] = Executed(future) if self._scheduler is None else Remote(self._scheduler, future, self._retries)

    def _again(self, task: int, error: BaseException) -> None:
        """A worker that failed is asked again, or another one."""
        if isinstance(error, SpringpotError):
            raise error
        self._tries[task] = self._tries.get(task, 0) + 1
        if self._tries[task] > self._retries:
            raise RunError(f"{self._called(task)} failed {self._tries[task]} times: {error}") from error
        self._submit(task)

    def cancel(self) -> None:
        """Takes back what has not begun."""
        for task in self._tasks.values():
            # A client that is broken takes nothing back, and has been told of already.
            with contextlib.suppress(Exception):
                task.cancel()


def _is_dask(client: Client) -> bool:
    return type(client).__module__.partition(".")[0] == "distributed"


def _workers(client: Client) -> int:
    threads = getattr(client, "nthreads", None)
    if callable(threads):
        try:
            return max(1, int(sum(threads().values())))
        except Exception as error:
            raise RunError(f"the client does not say how many workers it has: {error!r}") from error
    known = getattr(client, "_max_workers", None)
    return known if isinstance(known, int) and known > 0 else os.cpu_count() or 1


def _kept(study: Study, columns: str | Sequence[str] | None, rows: bool) -> list[int] | None:
    """Places of the columns that are wanted; ``None``: all."""
    if columns is None:
        return None if rows else []
    if not rows:
        raise ValueError("rows=False keeps no columns: leave `columns` out, or rows")
    names = [name for name, _, _ in study.columns[len(study.parameters) :]]
    places: list[int] = []
    for wanted in [columns] if isinstance(columns, str) else columns:
        found = [k for k, name in enumerate(names) if name == wanted or fnmatchcase(name, wanted)]
        if not found:
            raise KeyError(unknown("column", wanted, names))
        places.extend(found)
    return sorted(dict.fromkeys(places))


def sweep(
    scenario: Scenario,
    set: Mapping[str, Any] | None = None,
    sweep: Sweep | None = None,
    out: str | os.PathLike[str] | None = None,
    jobs: int | None = None,
    progress: Progress = None,
    *,
    columns: str | Sequence[str] | None = None,
    rows: bool = True,
    client: Client | Any | None = None,
    chunk: int | None = None,
    retries: int = 3,
    resume: bool = False,
    format: str = "csv",
    figures: bool = True,
) -> Run:
    """Runs the cases of a sweep on the workers of a ``client``: the same numbers, to the bit, and the same files as :func:`run`, in the same order.

    Files that the scenario names must be there for the workers under the same paths, and all must have the same build of Springpot.

    Args:
        scenario, set, sweep, out, jobs, progress, format, figures: as for :func:`run`.
        columns: names of the columns that come back from the workers, where ``*`` stands for any text; default all. Metrics, statistics, events and
            reports come in any case; such a run is not written, and not drawn as a scenario's figures.
        rows: ``False`` for none of the columns.
        client: a Dask ``Client``, the module ``ray``, a ``concurrent.futures`` executor, ``mpi4py.futures.MPIPoolExecutor``, or whatever has ``submit(work, *args)``
            and gives futures with ``result(timeout)`` (and ``done()``, if it likes); ``None``: threads here, as :func:`run`.
        chunk: cases in one task; default as many as give every worker sixteen tasks, at most 64.
        retries: how often a task is sent again whose worker failed.
        resume: go on with the run in ``out`` that was interrupted or whose client broke: cases that are in its files are not run again.

    Raises:
        RunError: a task failed more than ``retries`` times, the client takes no more work, gave something else than was asked, or lost its
            scheduler for good; with ``out`` what has come is kept for ``resume``.
    """
    chooses = columns is not None or not rows
    if chooses and out is not None:
        raise ValueError("what is written has all rows: leave `out` out, or name the columns in [output] of the scenario")
    if client is not None and is_ray(client):
        client = RayClient(client)
    if client is None and not resume and not chooses:
        return run(scenario, set, sweep, out, jobs, progress, format=format, figures=figures)
    if client is not None and not callable(getattr(client, "submit", None)):
        raise TypeError(f"client has no submit(work, *args): {type(client).__name__}")
    if getattr(client, "asynchronous", False) is True:
        raise ValueError("the client is asynchronous, and a sweep waits: give a Client(…, asynchronous=False)")
    if chunk is not None and chunk < 1:
        raise ValueError(f"chunk is a number of cases, not {chunk!r}")
    if resume and out is None:
        raise ValueError("resume goes on with a run in a folder: name it by out")
    study = Study(scenario, set, sweeps_of(sweep))
    _warn(study.warnings)
    kept = _kept(study, columns, rows)
    gathering = None if client is None else Gathering(study, client, chunk, retries, kept)
    try:
        with shown(progress) as told:
            if out is not None:
                return _written(study, gathering, os.fspath(out), jobs, told, format, figures, resume)
            cases: list[Case] = []
            if gathering is None:
                whole = study.cases(list(range(len(study))), jobs=_jobs(jobs), progress=told)
                return checked(Run(study, [case.with_columns(kept or []) for case in whole]))
            for index in range(len(study)):
                while (case := gathering.get(index, PATIENCE)) is None:
                    pass
                cases.append(case)
                if told is not None:
                    told(len(cases) / len(study))
            return checked(Run(study, cases))
    finally:
        if gathering is not None:
            gathering.cancel()


def _written(
    study: Study,
    gathering: Gathering | None,
    out: str,
    jobs: int | None,
    told: Any,
    format: str,
    figures: bool,
    resume: bool,
) -> Run:
    kept: dict[int, Case] = {}

    def get(index: int) -> Case | None:
        assert gathering is not None
        case = gathering.get(index, PATIENCE)
        if case is not None:
            kept[index] = case
        return case

    answer = study.write(
        out,
        cases=None if gathering is None else get,
        jobs=_jobs(jobs),
        format=format,
        figures=figures,
        journal=True,
        resume=resume,
        progress=told,
    )
    _warn(answer["warnings"])
    for case in answer["cases"]:
        kept[case.index] = case
    return checked(Run(study, [kept[index] for index in range(len(study))]))
