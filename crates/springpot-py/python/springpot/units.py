"""Units and quantities, as scenarios write them: ``"70 cm"``, ``"50 N*s^0.5/m"``, ``"25 degC"``."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from . import _springpot

__all__ = ["convert", "parse"]

_Number = TypeVar("_Number", float, NDArray[np.float64])


def parse(quantity: str | float, unit: str) -> float:
    """The SI value of a quantity that has the dimension of ``unit`` (empty: a pure number); a number is SI already.

    >>> import springpot as sp
    >>> sp.units.parse("25 degC", "K"), sp.units.parse("70 cm", "m"), sp.units.parse(3, "N")
    (298.15, 0.7, 3.0)

    Raises:
        ValueError: no quantity, or one of another dimension.
    """
    return _springpot.parse(quantity, unit)


def convert(value: _Number, unit: str, to: str) -> _Number:
    """Numbers of one unit in another one of the same dimension.

    >>> import springpot as sp
    >>> round(sp.units.convert(90.0, "deg", "rad"), 6), sp.units.convert(0.0, "degC", "K")
    (1.570796, 273.15)
    """
    (factor, shift, dimension), (other, zero, wanted) = _springpot.parse_unit(unit), _springpot.parse_unit(to)
    if not np.allclose(dimension, wanted, rtol=0.0, atol=1e-9):
        raise ValueError(f'"{unit}" and "{to}" are of different dimensions')
    return (value * factor + shift - zero) / other
