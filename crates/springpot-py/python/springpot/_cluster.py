"""Sweeps on other people's workers: Dask, concurrent.futures, MPI, Ray, or whatever takes tasks by ``submit``."""

from __future__ import annotations

import asyncio
import concurrent.futures
import os
from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Any, Protocol

from ._errors import RunError, SpringpotError
from ._progress import Progress, shown
from ._run import Run, Sweep, _jobs, _warn, checked, run
from ._scenario import Scenario
from ._springpot import Case, Study
from ._sweeps import sweeps_of

_TIMEOUTS = (TimeoutError, asyncio.TimeoutError, concurrent.futures.TimeoutError)

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


def work(payload: bytes, indices: Sequence[int]) -> list[bytes]:
    """Runs cases in a worker."""
    return [case.to_bytes() for case in _study(payload).cases(list(indices), jobs=1)]


class Gathering:
    """Cases of a study from the workers of a client, asked for in order."""

    def __init__(self, study: Study, client: Client, chunk: int | None, retries: int) -> None:
        self._client, self._retries = client, retries
        self._payload, self._count = study.to_bytes(), len(study)
        workers = _workers(client)
        shared = -(-self._count // (workers * TASKS_PER_WORKER))
        self._chunk = chunk if chunk is not None else max(1, min(MOST_IN_TASK, shared))
        self._ahead = max(2, AHEAD * workers)
        self._tasks: dict[int, Any] = {}
        self._tries: dict[int, int] = {}
        self._found: dict[int, bytes] = {}
        # Dask knows work by what it is given: a case that is asked for again is to run again.
        self._words = {"pure": False} if type(client).__module__.startswith("distributed") else {}

    def get(self, index: int, patience: float | None = None) -> Case | None:
        """The case, or ``None`` where it has not come within so many seconds."""
        task = index // self._chunk
        if index not in self._found:
            for ahead in range(task, min(task + self._ahead, -(-self._count // self._chunk))):
                if ahead not in self._tasks and ahead * self._chunk not in self._found:
                    self._submit(ahead)
            try:
                found = self._tasks[task].result(timeout=patience)
            except _TIMEOUTS:
                return None
            except Exception as error:
                self._again(task, error)
                return None
            del self._tasks[task]
            self._found.update(zip(self._indices(task), found))
        return Case.from_bytes(self._found.pop(index))

    def _indices(self, task: int) -> range:
        start = task * self._chunk
        return range(start, min(start + self._chunk, self._count))

    def _submit(self, task: int) -> None:
        try:
            self._tasks[task] = self._client.submit(work, self._payload, list(self._indices(task)), **self._words)
        except Exception as error:
            raise RunError(f"the client takes no more work: {error}") from error

    def _again(self, task: int, error: Exception) -> None:
        """A worker that failed is asked again, or another one."""
        if isinstance(error, SpringpotError):
            raise error
        self._tries[task] = self._tries.get(task, 0) + 1
        if self._tries[task] > self._retries:
            cases = self._indices(task)
            raise RunError(f"cases {cases.start} to {cases.stop - 1} failed {self._tries[task]} times: {error}") from error
        self._submit(task)

    def cancel(self) -> None:
        """Takes back what has not begun."""
        for future in self._tasks.values():
            cancel = getattr(future, "cancel", None)
            if cancel is not None:
                cancel()


def _workers(client: Client) -> int:
    threads = getattr(client, "nthreads", None)
    if callable(threads):
        return max(1, int(sum(threads().values())))
    known = getattr(client, "_max_workers", None)
    return known if isinstance(known, int) and known > 0 else os.cpu_count() or 1


def sweep(
    scenario: Scenario,
    set: Mapping[str, Any] | None = None,
    sweep: Sweep | None = None,
    out: str | os.PathLike[str] | None = None,
    jobs: int | None = None,
    progress: Progress = None,
    *,
    client: Client | None = None,
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
        client: a Dask ``Client``, a ``concurrent.futures`` executor, ``mpi4py.futures.MPIPoolExecutor``, or whatever has ``submit(work, *args)``
            and gives futures with ``result(timeout)``; ``None``: threads here, as :func:`run`.
        chunk: cases in one task; default as many as give every worker sixteen tasks, at most 64.
        retries: how often a task is sent again whose worker failed.
        resume: go on with the run in ``out`` that was interrupted or whose client broke: cases that are in its files are not run again.

    Raises:
        RunError: a task failed ``retries`` times, or the client takes no more work; with ``out`` what has come is kept for ``resume``.
    """
    if client is None and not resume:
        return run(scenario, set, sweep, out, jobs, progress, format=format, figures=figures)
    if client is not None and not callable(getattr(client, "submit", None)):
        raise TypeError(f"client has no submit(work, *args): {type(client).__name__}")
    if chunk is not None and chunk < 1:
        raise ValueError(f"chunk is a number of cases, not {chunk!r}")
    if resume and out is None:
        raise ValueError("resume goes on with a run in a folder: name it by out")
    study = Study(scenario, set, sweeps_of(sweep))
    _warn(study.warnings)
    gathering = None if client is None else Gathering(study, client, chunk, retries)
    try:
        with shown(progress) as told:
            if out is not None:
                return _written(study, gathering, os.fspath(out), jobs, told, format, figures, resume)
            assert gathering is not None
            cases: list[Case] = []
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
