"""Work that was sent to other people's workers, looked at without harming it."""

from __future__ import annotations

import asyncio
import concurrent.futures
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from ._errors import RunError

# Before 3.11 they are three classes.
_TIMEOUTS = (TimeoutError, asyncio.TimeoutError, concurrent.futures.TimeoutError)

LOST = 60.0
"""How long a Dask client may be without its scheduler, s; Dask itself gives up after half of that."""

_SHORTEST, _LONGEST = 1e-3, 0.02
"""Between two looks at what cannot be waited for, s."""


@dataclass(frozen=True)
class Came:
    """What a task gave."""

    value: Any


@dataclass(frozen=True)
class Failed:
    """What a task raised, or that its worker was killed."""

    error: BaseException


class Forgotten:
    """The task is no longer known: it is to be sent again, and nobody is to blame."""


def until(happened: Callable[[], bool], patience: float | None) -> bool:
    """Waits for something that only tells whether it has happened."""
    end = None if patience is None else time.monotonic() + patience
    pause = _SHORTEST
    while not happened():
        left = pause if end is None else end - time.monotonic()
        if left <= 0:
            return False
        time.sleep(min(pause, left))
        pause = min(2 * pause, _LONGEST)
    return True


class Executed:
    """A future as ``concurrent.futures`` has them: its result is here once it is done."""

    def __init__(self, future: Any) -> None:
        if not callable(getattr(future, "result", None)):
            raise RunError(f"submit gave {type(future).__name__}, which is no future: it has no result(timeout)")
        self._future = future

    def look(self, patience: float | None) -> Came | Failed | None:
        """What came of it, ``None`` where it is still under way after so many seconds."""
        done = getattr(self._future, "done", None)
        try:
            if isinstance(self._future, concurrent.futures.Future):
                if not concurrent.futures.wait([self._future], patience).done:
                    return None
            elif callable(done):
                if not until(done, patience):
                    return None
            else:
                try:
                    return Came(self._future.result(timeout=patience))
                except _TIMEOUTS:
                    return None
            return Came(self._future.result())
        except (Exception, asyncio.CancelledError) as error:
            return Failed(error)

    def cancel(self) -> None:
        """Takes it back where it has not begun."""
        cancel = getattr(self._future, "cancel", None)
        if cancel is not None:
            cancel()


class Scheduler:
    """The scheduler of a Dask client, as far as the client knows."""

    def __init__(self, client: Any) -> None:
        self._client = client
        self._lost_at: float | None = None

    @property
    def is_here(self) -> bool:
        """Whether the client has it."""
        return bool(self._client.status == "running")

    def check(self) -> None:
        """Raises:
        RunError: it has gone.
        """
        status = self._client.status
        if status == "running":
            self._lost_at = None
            return
        now = time.monotonic()
        self._lost_at = now if self._lost_at is None else self._lost_at
        if status != "connecting" or now - self._lost_at > LOST:
            raise RunError(f"the scheduler of the client has gone: the client is {status}")


class Remote:
    """A future of a Dask client: what a task gave is fetched by a thread of its own, once and as long as it takes.

    A look with a time-out at ``result`` would cancel the transfer with every look; what it raises is none of the task's failures.
    """

    def __init__(self, scheduler: Scheduler, future: Any, retries: int) -> None:
        self._scheduler, self._future, self._retries = scheduler, future, retries
        self._fetch: _Fetch | None = None

    def look(self, patience: float | None) -> Came | Failed | Forgotten | None:
        """As :meth:`Executed.look`.

        Raises:
            RunError: the scheduler has gone, or what the task gave cannot be fetched.
        """
        if not until(self._is_at_hand, patience):
            self._scheduler.check()
            return None
        fetch = self._fetch
        if fetch is None:
            # The client forgets what it sent when it loses the scheduler.
            if until(lambda: self._scheduler.is_here, patience):
                return Forgotten()
            self._scheduler.check()
            return None
        if fetch.error is None:
            return Came(fetch.value)
        self._fetch = None
        status = self._future.status
        if status == "error":
            return Failed(fetch.error)
        if status != "cancelled":
            self._retries -= 1
            if self._retries < 0:
                raise RunError(f"what a worker found cannot be fetched: {fetch.error!r}") from fetch.error
        return None

    def _is_at_hand(self) -> bool:
        """Whether it was fetched, or is none that could be."""
        if self._fetch is not None:
            return not self._fetch.is_alive()
        status = self._future.status
        if status in ("finished", "error"):
            self._fetch = _Fetch(self._future)
            self._fetch.start()
            return False
        return bool(status == "cancelled")

    def cancel(self) -> None:
        """Takes it back where it has not begun."""
        if self._scheduler.is_here:
            self._future.cancel()


class _Fetch(threading.Thread):
    """Brings a result here; it ends with the process where the other end never answers."""

    def __init__(self, future: Any) -> None:
        super().__init__(name="springpot-fetch", daemon=True)
        self._future = future
        self.value: Any = None
        self.error: BaseException | None = None

    def run(self) -> None:
        try:
            self.value = self._future.result()
        except BaseException as error:
            self.error = error
