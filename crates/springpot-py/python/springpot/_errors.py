"""What can go wrong; importable without the compiled module."""

from __future__ import annotations

import errno
from typing import Any


class SpringpotError(Exception):
    """Whatever Springpot refuses or fails at."""


class SpringpotWarning(UserWarning):
    """What a run tells of, and does not fail at; ``warnings.filterwarnings("ignore", category=sp.SpringpotWarning)`` silences it."""


class ScenarioError(SpringpotError, ValueError):
    """A scenario is refused; where its file is not there, this is a ``FileNotFoundError`` too.

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


class _MissingFile(FileNotFoundError):
    """What Springpot's own message says of a file that is not there.

    Attributes:
        filename: as it was asked for.
    """

    def __str__(self) -> str:
        return str(self.args[0]) if self.args else ""

    def __reduce__(self) -> tuple[Any, ...]:
        # Names of files are no part of what exceptions keep of themselves.
        return _missing, (type(self), *self.args), {**vars(self), "filename": self.filename}


def _missing(kind: type[_MissingFile], message: str = "") -> _MissingFile:
    return kind(message)


class MissingScenarioError(ScenarioError, _MissingFile):
    """The file of a scenario is not there."""

    def __init__(self, message: str = "", *, filename: str | None = None, **place: Any) -> None:
        super().__init__(message, **place)
        self.errno, self.filename = errno.ENOENT, filename


class ModelError(SpringpotError):
    """A robot cannot be, or has no such part; where its file is not there, this is a ``FileNotFoundError`` too."""


class MissingModelError(ModelError, _MissingFile):
    """The file of a robot is not there."""

    def __init__(self, message: str = "", *, filename: str | None = None) -> None:
        super().__init__(message)
        self.errno, self.filename = errno.ENOENT, filename


class MissingResultsError(SpringpotError, _MissingFile):
    """The folder of results is not there."""

    def __init__(self, message: str = "", *, filename: str | None = None) -> None:
        super().__init__(message)
        self.errno, self.filename = errno.ENOENT, filename


class RunError(SpringpotError):
    """A run or a simulation cannot go on.

    Attributes:
        t: when it happened, s; ``None`` where no time is to blame.
    """

    t: float | None

    def __init__(self, message: str = "", *, t: float | None = None) -> None:
        super().__init__(message)
        self.t = t
