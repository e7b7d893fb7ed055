"""Elements between two points, as Python describes them to other engines."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from . import units
from ._springpot import Law

Array: TypeAlias = NDArray[np.float64]
Signal: TypeAlias = "float | str | Callable[[float], float]"

_LAW = ("law", "network", "parameters", "derivative")
_KEYS = ("name", "from", "to", "rest_length", "inputs", *_LAW)


@dataclass(frozen=True)
class Element:
    """One element: ends that the engine knows, l0 in m (``None``: the length where it begins), and what the bank knows."""

    name: str
    start: Any
    end: Any
    rest_length: float | None
    law: dict[str, Any]
    inputs: dict[str, Signal]


def described(elements: Sequence[Mapping[str, Any]]) -> list[Element]:
    """Elements from dicts.

    Raises:
        TypeError: an element is no mapping.
        ValueError: a key is unknown or missing, a rest length is negative or of another dimension.
    """
    return [_element(element, str(k)) for k, element in enumerate(elements)]


def _element(said: Mapping[str, Any], number: str) -> Element:
    if not isinstance(said, Mapping):
        raise TypeError(f"an element is a dict, not {type(said).__name__}")
    name = str(said.get("name", number))
    for key in said:
        if key not in _KEYS:
            near = difflib.get_close_matches(str(key), _KEYS, n=1)
            help = f'did you mean "{near[0]}"?' if near else f"there are {', '.join(_KEYS)}"
            raise ValueError(f'element "{name}": there is no key "{key}"; {help}')
    for key in ("from", "to", "rest_length"):
        if key not in said:
            raise ValueError(f'element "{name}": "{key}" is missing')
    law: dict[str, Any] = {key: said[key] for key in _LAW if key in said}
    if isinstance(law.get("law"), Law):
        law = {**law.pop("law").description, **law}
    return Element(name, said["from"], said["to"], _rest_length(name, said["rest_length"]), law | {"name": name}, dict(said.get("inputs", {})))


def _rest_length(name: str, said: Any) -> float | None:
    if isinstance(said, str) and said == "start":
        return None
    try:
        length = units.parse(said, "m")
    except ValueError as error:
        raise ValueError(f'element "{name}": rest_length: {error}') from None
    if not (np.isfinite(length) and length >= 0.0):
        raise ValueError(f'element "{name}": rest_length is {length} m; it must be finite, and not negative')
    return length


class Inputs:
    """Inputs of all elements: numbers, texts with a unit, or functions of t."""

    def __init__(self, elements: Sequence[Element], known: Sequence[str]) -> None:
        self._signals = {f"{element.name}.{key}": signal for element in elements for key, signal in element.inputs.items()}
        for name in self._signals:
            if name not in known:
                near = difflib.get_close_matches(name, known, n=1)
                help = f'did you mean "{near[0]}"?' if near else f"there are {', '.join(known) or 'none'}"
                raise ValueError(f'there is no input "{name}"; {help}')
        for name in known:
            if name not in self._signals:
                element, _, key = name.rpartition(".")
                raise ValueError(f'element "{element}": the input "{key}" is missing: inputs={{"{key}": …}}')

    def copy(self) -> Inputs:
        """Signals of its own."""
        other = Inputs([], [])
        other._signals = dict(self._signals)
        return other

    def set(self, name: str, signal: Signal) -> None:
        if name not in self._signals:
            raise ValueError(f'there is no input "{name}"; there are {", ".join(self._signals) or "none"}')
        self._signals[name] = signal

    def at(self, t: float) -> dict[str, float | str]:
        return {name: signal(t) if callable(signal) else signal for name, signal in self._signals.items()}

    def over(self, times: Array) -> dict[str, float | str | Array]:
        """At several times, shape ``(nodes,)``."""
        return {
            name: np.array([signal(float(t)) for t in times]) if callable(signal) else signal for name, signal in self._signals.items()
        }
