"""Columns of runs as functions that JAX differentiates, under ``jit`` and ``vmap``.

An extra: ``pip install springpot[jax]``. Runs are made on the host in float64, so that ``jax_enable_x64`` is wanted.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from ._gradient import Columns
from ._scenario import Scenario

__all__ = ["columns"]


def columns(
    scenario: Scenario, by: str | Sequence[str], of: str | Sequence[str], *, set: Mapping[str, Any] | None = None
) -> Callable[[Any], Any]:
    """A function of an array ``(P,)``, the SI values of ``by``, to an array ``(N, C)``: the rows of the columns ``of``.

    ``jax.jvp``, ``jax.vjp``, ``jax.jacobian`` and ``jax.grad`` of what follows take the exact derivatives of the run; one run gives values and
    derivatives. Its attributes: ``parameters`` and ``columns`` are names, ``start`` the values of the scenario. A run that fails raises.
    """
    found = Columns(scenario, by, of, set)
    shape = (found.rows, len(found.columns))

    def values(p: Any) -> Any:
        return np.asarray(found(np.asarray(p))[0], dtype=np.asarray(p).dtype)

    def slopes(p: Any) -> Any:
        return np.asarray(found(np.asarray(p))[1], dtype=np.asarray(p).dtype)

    @jax.custom_jvp
    def function(p: Any) -> Any:
        return jax.pure_callback(values, jax.ShapeDtypeStruct(shape, p.dtype), p, vmap_method="sequential")

    @function.defjvp
    def _(primals: Any, tangents: Any) -> Any:
        (p,), (dp,) = primals, tangents
        told = jax.ShapeDtypeStruct((*shape, len(found.parameters)), p.dtype)
        jacobian = jax.pure_callback(slopes, told, p, vmap_method="sequential")
        return function(p), jacobian @ dp

    def wrapped(p: Any) -> Any:
        p = jnp.asarray(p)
        return function(p if jnp.issubdtype(p.dtype, jnp.floating) else p.astype(float))

    wrapped.parameters = found.parameters  # type: ignore[attr-defined]
    wrapped.columns = found.columns  # type: ignore[attr-defined]
    wrapped.start = found.start  # type: ignore[attr-defined]
    return wrapped
