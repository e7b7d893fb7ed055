"""Columns of runs as functions that PyTorch differentiates.

An extra: ``pip install springpot[torch]``. Runs are made on the CPU in float64.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import torch

from ._gradient import Columns
from ._scenario import Scenario

__all__ = ["columns"]


class _Rows(torch.autograd.Function):
    """Values and, beside them, their derivatives, which are not differentiated again."""

    @staticmethod
    def forward(p: Any, found: Columns) -> Any:
        y, slopes = found(p.detach().cpu().double().numpy())
        return tuple(torch.as_tensor(part).to(p) for part in (y, slopes))

    @staticmethod
    def setup_context(ctx: Any, inputs: Any, output: Any) -> None:
        ctx.mark_non_differentiable(output[1])
        ctx.save_for_backward(output[1])
        ctx.save_for_forward(output[1])

    @staticmethod
    def backward(ctx: Any, *outer: Any) -> Any:
        (slopes,) = ctx.saved_tensors
        return torch.einsum("nc,ncp->p", outer[0], slopes), None

    @staticmethod
    def jvp(ctx: Any, *inputs: Any) -> Any:
        (slopes,) = ctx.saved_tensors
        return slopes @ inputs[0], None

    @staticmethod
    def vmap(info: Any, in_dims: Any, p: Any, found: Columns) -> Any:
        each = [_Rows.apply(p.select(in_dims[0], k), found) for k in range(info.batch_size)]
        return tuple(torch.stack(parts) for parts in zip(*each)), (0, 0)


def columns(
    scenario: Scenario, by: str | Sequence[str], of: str | Sequence[str], *, set: Mapping[str, Any] | None = None
) -> Callable[[Any], Any]:
    """A function of a tensor ``(P,)``, the SI values of ``by``, to a tensor ``(N, C)``: the rows of the columns ``of``.

    ``backward`` and forward-mode derivatives take the exact ones of the run; one run gives values and derivatives. Its attributes: ``parameters``
    and ``columns`` are names, ``start`` the values of the scenario. A run that fails raises.
    """
    found = Columns(scenario, by, of, set)

    def wrapped(p: Any) -> Any:
        return _Rows.apply(p, found)[0]

    wrapped.parameters = found.parameters  # type: ignore[attr-defined]
    wrapped.columns = found.columns  # type: ignore[attr-defined]
    wrapped.start = found.start  # type: ignore[attr-defined]
    return wrapped
