"""Small tables: rows of dicts that are also columns."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, overload

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    import pandas


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
            raise KeyError(name)
        return np.asarray([row[name] for row in self._rows])

    def __iter__(self) -> Iterator[dict[str, Any]]:
        return iter(self._rows)

    def __len__(self) -> int:
        return len(self._rows)

    def __repr__(self) -> str:
        return f"<{len(self)} rows>"

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
            return super()._column(name)
        return values[0] if self._cases == 1 else np.asarray(values)
