"""How far a run is, on the terminal or to a callable."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeAlias

Progress: TypeAlias = "bool | Callable[[float], object] | None"


@contextmanager
def shown(progress: Progress) -> Iterator[Callable[[float], object] | None]:
    """What is to be told the share that is done."""
    if progress is None or progress is False:
        yield None
    elif callable(progress):
        yield progress
    elif progress is True:
        with _bar() as told:
            yield told
    else:
        raise TypeError(f"progress is True, False or a callable, not {type(progress).__name__}")


@contextmanager
def _bar() -> Iterator[Callable[[float], object]]:
    try:
        from tqdm.auto import tqdm
    except ImportError:
        yield _percent
        print(file=sys.stderr)
        return
    with tqdm(total=100, unit="%", bar_format="{l_bar}{bar}| {elapsed}<{remaining}") as bar:

        def told(share: float) -> None:
            bar.update(100 * share - bar.n)

        yield told


def _percent(share: float) -> None:
    print(f"\r{100 * share:5.1f} %", end="", file=sys.stderr, flush=True)
