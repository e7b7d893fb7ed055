"""Ray as a client of sweeps: the module ``ray`` has tasks, and no ``submit``."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


def is_ray(client: object) -> bool:
    """Whether it is the module ``ray``, or looks so."""
    return all(callable(getattr(client, name, None)) for name in ("remote", "put", "get", "wait", "cancel")) and not hasattr(client, "submit")


class RayClient:
    """``submit`` by tasks of Ray, which start Ray where it has not been."""

    def __init__(self, ray: Any) -> None:
        self._ray = ray
        self._put: tuple[bytes, Any] | None = None
        if not ray.is_initialized():
            ray.init()
        self._max_workers = max(1, int(ray.cluster_resources().get("CPU", 1)))

    def submit(self, work: Callable[..., Any], payload: bytes, *others: Any) -> RayFuture:
        """Sends a task; what all tasks share goes to every machine once. Tasks are sent again by the sweep alone."""
        if self._put is None or self._put[0] is not payload:
            self._put = (payload, self._ray.put(payload))
        task = self._ray.remote(max_retries=0)(work)
        return RayFuture(self._ray, task.remote(self._put[1], *others))


class RayFuture:
    """A task of Ray as a future."""

    def __init__(self, ray: Any, reference: Any) -> None:
        self._ray, self._reference = ray, reference

    def done(self) -> bool:
        """Whether it has ended, well or not."""
        return bool(self._ray.wait([self._reference], timeout=0)[0])

    def result(self, timeout: float | None = None) -> Any:
        """What it gave; raises what it raised."""
        return self._ray.get(self._reference, timeout=timeout)

    def cancel(self) -> None:
        """Takes it back."""
        self._ray.cancel(self._reference)
