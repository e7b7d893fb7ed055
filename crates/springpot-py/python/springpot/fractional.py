"""Fractional calculus: derivatives and integrals of samples, Mittag-Leffler functions."""

from __future__ import annotations

from typing import Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _springpot

__all__ = ["derivative", "mittag_leffler"]

_Array = NDArray[np.float64]


@overload
def derivative(
    t: ArrayLike,
    x: ArrayLike,
    order: float,
    definition: str = ...,
    method: str = ...,
    *,
    rates: ArrayLike | None = ...,
    with_error: Literal[False] = ...,
) -> _Array: ...
@overload
def derivative(
    t: ArrayLike,
    x: ArrayLike,
    order: float,
    definition: str = ...,
    method: str = ...,
    *,
    rates: ArrayLike | None = ...,
    with_error: Literal[True],
) -> tuple[_Array, _Array]: ...
def derivative(
    t: ArrayLike,
    x: ArrayLike,
    order: float,
    definition: str = "caputo",
    method: str = "spline",
    *,
    rates: ArrayLike | None = None,
    with_error: bool = False,
) -> _Array | tuple[_Array, _Array]:
    """D^order of samples; of a negative order the integral. The lower terminal is the first time.

    Args:
        t: times, s, ascending, shape ``(N,)``.
        x: samples, shape ``(N,)`` or ``(N, K)`` for K columns.
        order: −2 … 2.
        definition: ``"caputo"`` or ``"riemann-liouville"``.
        method: ``"spline"`` (order 7 − a on smooth samples), ``"hermite"``, ``"exponential"``, or a named scheme: ``"l1"``, ``"l1-2"``,
            ``"grunwald-letnikov"``, ``"fbdf-1"`` … ``"fbdf-6"``, ``"expansion-2004(N)"``, ``"expansion-2008(N)"``.
        rates: x' at the samples, for ``"hermite"``, in the shape of x.
        with_error: whether an estimate of |error| at every sample is wanted too.

    Returns:
        D^order x in the shape of x, NaN where it is infinite; with ``with_error`` a tuple of it and the estimate.

    >>> import numpy as np, springpot as sp
    >>> t = np.linspace(0.0, 1.0, 101)
    >>> half = sp.fractional.derivative(t, t**2, 0.5)
    >>> bool(np.allclose(half, 8 / (3 * np.sqrt(np.pi)) * t**1.5, rtol=1e-12))
    True
    """
    values, errors = _springpot.differentiate(t, x, order, definition, method, rates, with_error)
    return values if errors is None else (values, errors)


def mittag_leffler(z: ArrayLike, a: float, b: float = 1.0, *, derivative: int = 0) -> Any:
    """The Mittag-Leffler function E_{a,b}(z) to 1e-12, or its derivative of an integer order.

    Args:
        z: real or complex, any shape.
        a: positive.
        b: real.
        derivative: dⁿ/dzⁿ, n ≥ 0.

    Returns:
        In the shape of z; real for real z, a number for a number.

    >>> import springpot as sp
    >>> round(sp.fractional.mittag_leffler(-1.0, 1.0), 12)  # exp(−1)
    0.367879441171
    >>> sp.fractional.mittag_leffler([0.0, 1j], 1.0).shape
    (2,)
    """
    found = np.asarray(z)
    if found.dtype.kind not in "biufc":
        raise TypeError(f"z must be an array of numbers, not of {found.dtype}")
    if found.dtype.kind == "c":
        flat = np.ascontiguousarray(found, dtype=np.complex128).ravel()
        values: Any = _springpot.mittag_leffler_complex(flat, a, b, derivative).reshape(found.shape)
    else:
        real = np.ascontiguousarray(found, dtype=np.float64).ravel()
        values = _springpot.mittag_leffler_real(real, a, b, derivative).reshape(found.shape)
    return values if found.shape else values.item()
