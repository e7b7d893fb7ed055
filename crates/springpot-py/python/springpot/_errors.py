"""What can go wrong; importable without the compiled module."""

from __future__ import annotations


class SpringpotError(Exception):
    """Whatever Springpot refuses or fails at."""


class ScenarioError(SpringpotError):
    """A scenario is refused.

    Attributes:
        path: the file, or ``<text>``, ``<dict>``, ``--set``; ``None`` where no place is to blame.
        line: from 1.
        column: from 1, in characters.
        help: what would be right, if that is known.
        refusals: all that was found, each ``(path, line, column, message, help)``; the attributes above are those of the first.
    """

    path: str | None
    line: int | None
    column: int | None
    help: str | None
    refusals: tuple[tuple[str, int, int, str, str | None], ...]

    def __init__(
        self,
        message: str = "",
        *,
        path: str | None = None,
        line: int | None = None,
        column: int | None = None,
        help: str | None = None,
        refusals: tuple[tuple[str, int, int, str, str | None], ...] = (),
    ) -> None:
        super().__init__(message)
        self.path, self.line, self.column, self.help, self.refusals = path, line, column, help, refusals


class ModelError(SpringpotError):
    """A robot cannot be, or has no such part."""


class RunError(SpringpotError):
    """A run or a simulation cannot go on.

    Attributes:
        t: when it happened, s; ``None`` where no time is to blame.
    """

    t: float | None

    def __init__(self, message: str = "", *, t: float | None = None) -> None:
        super().__init__(message)
        self.t = t
