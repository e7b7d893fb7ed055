"""What elements ask of the joints, as columns for the numbers of their laws."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._springpot import Model
from .fractional import derivative

_Point = tuple[str, Sequence[float]]


def element_regressor(
    model: Model,
    from_: _Point,
    to: _Point,
    t: ArrayLike,
    q: ArrayLike,
    rest_length: float,
    orders: Sequence[float],
    definition: str = "caputo",
) -> NDArray[np.float64]:
    """Columns for the coefficients c of an element F = Σ c_k D^order_k x between two points, along a motion.

    The element has the generalized force −F ∂l/∂q, so that what the joints are asked for, tau = Y pi + Σ c_k ∂l/∂q D^order_k x, is linear in c: with
    :meth:`Model.joint_torque_regressor` beside it, one least-squares problem finds bodies and materials.

    Args:
        model: the robot.
        from_, to: a body and a place there, m, each: ``("forearm", [0.1, 0, 0])``.
        t: times, s, ascending, shape ``(N,)``.
        q: the robot there, shape ``(N, nq)``.
        rest_length: l0 of the stroke x = l − l0, m.
        orders: 0 for a spring, 1 for a dashpot, between them for a springpot.
        definition: ``"caputo"``, held at x(0) before, or ``"riemann-liouville"``, unloaded before.

    Returns:
        ``(N, nv, len(orders))``: N·m or N for each unit of c_k, N·s^order/m.

    >>> import numpy as np, springpot as sp
    >>> slider = sp.Model.from_scenario({"robot": {"body": [{"name": "mass", "mass": 2,
    ...     "joint": {"name": "x", "kind": "prismatic", "axis": [1, 0, 0]}}]}})
    >>> t = np.linspace(0, 1, 101)
    >>> columns = sp.element_regressor(slider, ("world", [-1, 0, 0]), ("mass", [0, 0, 0]), t, t[:, None] ** 2, 1.0, [0, 1])
    >>> columns.shape, columns[50].round(6).tolist()
    ((101, 1, 2), [[0.25, 1.0]])
    """
    length, gradient = model.pair_length(from_, to, q)
    stroke = np.asarray(length) - rest_length
    along = [stroke if order == 0 else derivative(t, stroke, order, definition) for order in orders]
    return gradient[:, :, None] * np.stack(along, axis=-1)[:, None, :]
