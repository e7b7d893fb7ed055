"""Small tables: rows of dicts that are also columns."""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, overload

import numpy as np
import numpy.typing as npt

from . import _html

if TYPE_CHECKING:
    import pandas


def unknown(what: str, name: object, names: Sequence[str]) -> str:
    """What to say of a name that is none of these."""
    near = difflib.get_close_matches(str(name), names, n=1)
    if near:
        return f"no {what} {name!r}; did you mean {near[0]!r}?"
    return f"no {what} {name!r}; there {'is' if len(names) == 1 else 'are'} {', '.join(names) or 'none'}"


def swept_column(values: Sequence[float | str]) -> npt.NDArray[Any]:
    """Swept values as a column: numbers beside texts are the texts that they are in results.csv, so that it has one type."""
    if any(isinstance(value, str) for value in values):
        values = [value if isinstance(value, str) else repr(value).removesuffix(".0") for value in values]
    return np.asarray(values)


class Rows(Sequence[dict[str, Any]]):
    """Rows as dicts; a name in the place of an index gives a column as an array ``(rows,)``."""

    def __init__(self, rows: list[dict[str, Any]]) -> None:
        self._rows = rows

    @overload
    def __getitem__(self, key: int) -> dict[str, Any]: ...
    @overload
    def __getitem__(self, key: slice) -> Sequence[dict[str, Any]]: ...
    @overload
    def __getitem__(self, key: str) -> Any: ...
    def __getitem__(self, key: int | slice | str) -> Any:
        if isinstance(key, str):
            return self._column(key)
        return self._rows[key]

    def _column(self, name: str) -> npt.NDArray[Any]:
        if self._rows and name not in self._rows[0]:
            raise KeyError(unknown("column", name, self._names()))
        return np.asarray([row[name] for row in self._rows])

    def __iter__(self) -> Iterator[dict[str, Any]]:
        return iter(self._rows)

    def __len__(self) -> int:
        return len(self._rows)

    def _names(self) -> list[str]:
        return list(self._rows[0]) if self._rows else []

    def _ipython_key_completions_(self) -> list[str]:
        return self._names()

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Rows):
            return NotImplemented
        # A value that is not there is NaN, which is as good as another one.
        return type(self) is type(other) and self._plain() == other._plain()

    __hash__ = None  # type: ignore[assignment]

    def _plain(self) -> list[dict[str, Any]]:
        return [{name: None if value != value else value for name, value in row.items()} for row in self._rows]

    def __repr__(self) -> str:
        count = "1 row" if len(self) == 1 else f"{len(self)} rows"
        return f"<{type(self).__name__}: {count}{' of ' if self._rows else ''}{', '.join(self._names())}>"

    def _repr_html_(self) -> str:
        return _html.rows(self)

    def to_pandas(self) -> pandas.DataFrame:
        """The rows as a pandas frame."""
        import pandas

        return pandas.DataFrame(self._rows)


class Metrics(Rows):
    """Rows of metrics; the name of one gives its value: of the only case a float, of several an array ``(cases,)``."""

    def __init__(self, rows: list[dict[str, Any]], cases: int) -> None:
        super().__init__(rows)
        self._cases = cases

    def _column(self, name: str) -> Any:
        values = [row["value"] for row in self._rows if row["metric"] == name]
        if not values:
            if name not in super()._names():
                raise KeyError(unknown("metric", name, self._called() or super()._names()))
            return super()._column(name)
        return values[0] if self._cases == 1 else np.asarray(values)

    def _called(self) -> list[str]:
        return list(dict.fromkeys(row["metric"] for row in self._rows))

    def _ipython_key_completions_(self) -> list[str]:
        return [*self._called(), *self._names()]

    def __repr__(self) -> str:
        cases = "1 case" if self._cases == 1 else f"{self._cases} cases"
        return f"<Metrics of {cases}: {', '.join(self._called()) or 'none'}>"
