"""What the commands ``check``, ``modulus`` and ``fmu`` do, as functions."""

from __future__ import annotations

import math
import os
import pathlib
import tempfile
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _html, units
from . import _springpot
from ._errors import SpringpotWarning
from ._scenario import Scenario

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Finding:
    """What a run of a scenario goes on in spite of, and its author should know.

    Attributes:
        message: what it is, with the value.
        help: what can be done, or ``None``.
        path: the file, ``<text>`` or ``<dict>``; ``None`` where it stands in no one place.
        line: from 1, or ``None``.
        column: from 1, in characters, or ``None``.
    """

    message: str
    help: str | None
    path: str | None
    line: int | None
    column: int | None

    def __str__(self) -> str:
        place = "" if self.path is None else f"{self.path}:{self.line}:{self.column}: "
        return f"{place}{self.message}{'' if self.help is None else f'; {self.help}'}"


def check(scenario: Scenario, set: Mapping[str, Any] | None = None) -> list[Finding]:
    """Looks a scenario through without running it, as ``springpot check`` does: all that deserves a warning, in any of its cases.

    Raises:
        ScenarioError: the scenario is refused; ``refusals`` are all that was found.
        RunError: a case is known to fail.
    """
    found = _springpot.check(scenario, set)
    return [Finding(message, help, *(place or (None, None, None))) for message, help, place in found]


@dataclass(frozen=True, eq=False)
class Modulus:
    """K* = K′ + iK″ of an element under x = A sin ωt.

    Attributes:
        element: its name.
        unit: of ``storage`` and ``loss``: N/m, or N*m/rad where it acts on an angle.
        frequency: shape ``(n,)``, Hz.
        amplitude: m or rad, a number, or shape ``(A,)`` where several are asked for.
        storage: K′, shape ``(n,)``, or ``(A, n)`` of several amplitudes.
        loss: K″, likewise.
        cycle: energy lost in a cycle, likewise, J.
    """

    element: str
    unit: str
    frequency: Array
    amplitude: float | Array
    storage: Array
    loss: Array
    cycle: Array

    @property
    def tan_delta(self) -> Array:
        """K″/K′."""
        return self.loss / self.storage

    @property
    def complex(self) -> npt.NDArray[np.complex128]:
        """K′ + iK″."""
        return self.storage + 1j * self.loss

    def __repr__(self) -> str:
        several = f", {len(self.amplitude)} amplitudes" if isinstance(self.amplitude, np.ndarray) else ""
        return f"<Modulus of {self.element}: {len(self.frequency)} frequencies{several}, {self.unit}>"

    def _repr_html_(self) -> str:
        head = ["frequency, Hz", "amplitude", f"storage, {self.unit}", f"loss, {self.unit}", "tan delta", "cycle, J"]
        shape = np.broadcast_shapes(self.storage.shape)
        amplitude = np.broadcast_to(np.reshape(self.amplitude, (-1, 1)), (max(np.size(self.amplitude), 1), len(self.frequency)))
        columns = [np.broadcast_to(self.frequency, shape), amplitude, self.storage, self.loss, self.tan_delta, self.cycle]
        return _html.table(f"K* of {self.element}", head, zip(*(column.ravel() for column in columns)), self.storage.size)


def modulus(
    scenario: Scenario,
    element: str,
    amplitude: float | str | Sequence[float | str] | Array | None = None,
    frequencies: float | str | Sequence[float | str] | Array = (1.0,),
    *,
    set: Mapping[str, Any] | None = None,
) -> Modulus:
    """The modulus of an element under a steady sine of its stroke, as ``springpot modulus`` gives it: of a law that is not linear the first harmonic.

    Args:
        scenario, set: as for :func:`run`; of a sweep the first case counts.
        element: its name.
        amplitude: m or rad, numbers or texts such as ``"1 mm"``; one or several. Laws that are linear need none.
        frequencies: Hz, numbers or texts such as ``"10 Hz"`` and ``"60 rad/s"``; one or several.

    Raises:
        ScenarioError: the scenario is refused.
        ValueError: no such element, an amplitude or a frequency that is not above 0, no amplitude where the law needs one.
        RunError: the law comes to no steady turn.
    """
    hertz = [_hertz(one) for one in _each(frequencies)]
    strokes = None if amplitude is None else [_stroke(one) for one in _each(amplitude)]
    (_, unit), _, rows = _springpot.modulus(scenario, element, hertz, strokes, set)
    is_several = amplitude is not None and not isinstance(amplitude, str) and np.ndim(amplitude) > 0
    table = np.asarray(rows).reshape(-1, len(hertz), 5)
    if not is_several:
        table = table[0]
    amplitudes = table[..., 0, 1]
    return Modulus(
        element=element,
        unit=unit,
        frequency=np.asarray(hertz),
        amplitude=amplitudes.copy() if is_several else float(amplitudes),
        storage=table[..., 2].copy(),
        loss=table[..., 3].copy(),
        cycle=table[..., 4].copy(),
    )


def _each(values: Any) -> list[Any]:
    listed = [values] if isinstance(values, str) or np.ndim(values) == 0 else list(values)
    if not listed:
        raise ValueError("no frequencies or amplitudes are given")
    return listed


def _hertz(value: float | str) -> float:
    if isinstance(value, str) and not value.rstrip().endswith("Hz"):
        if "rad" not in value and "deg" not in value:
            raise ValueError(f"{value!r} does not say whether turns (Hz) or radians (rad/s) are counted")
        number = units.parse(value, "rad/s") / math.tau
    else:
        number = units.parse(value, "Hz") if isinstance(value, str) else float(value)
    return _positive(number, value, "frequency")


def _stroke(value: float | str) -> float:
    if not isinstance(value, str):
        return _positive(float(value), value, "stroke")
    try:
        number = units.parse(value, "m")
    except ValueError:
        number = units.parse(value, "rad")
    return _positive(number, value, "stroke")


def _positive(number: float, value: object, what: str) -> float:
    if not (number > 0.0 and math.isfinite(number)):
        raise ValueError(f"{value!r} is no {what} above 0")
    return number


def fmu(
    scenario: Scenario,
    out: str | os.PathLike[str] | None = None,
    *,
    set: Mapping[str, Any] | None = None,
    library: str | os.PathLike[str] | None = None,
) -> pathlib.Path:
    """Writes a scenario with its files as an FMU (FMI 2.0, co-simulation) of this platform, as ``springpot fmu`` does.

    What runs in it comes with this package; other programs need neither Python nor Springpot for it.

    Args:
        scenario, set: as for :func:`run`.
        out: the file, ``.fmu``; default the scenario's name in the current folder, ``scenario.fmu`` of a text or a dict.
        library: the file of another library, such as one that knows laws of your own.

    Returns:
        The file that was written.

    Raises:
        ScenarioError: the scenario is refused.
        RunError: it cannot start.
        ValueError: it cannot be an FMU (several cases, named schemes), ``out`` is no ``.fmu``, there is no library.
    """
    is_file = isinstance(scenario, os.PathLike) or (isinstance(scenario, str) and "\n" not in scenario and "=" not in scenario)
    stem = pathlib.Path(os.fspath(scenario)).stem if is_file else "scenario"  # type: ignore[arg-type]
    path = pathlib.Path(f"{stem}.fmu") if out is None else pathlib.Path(out)
    if path.suffix.lower() != ".fmu":
        raise ValueError(f"{path} is no .fmu: other tools know an FMU by the end of its name")
    with tempfile.TemporaryDirectory(prefix="springpot-") as folder:
        archive, silent = _springpot.fmu(scenario, stem, folder, set, None if library is None else os.fspath(library))
    for event in silent:
        message = f"event {event!r} is not in the FMU: its master sees the columns and says what happens"
        warnings.warn(message, SpringpotWarning, stacklevel=2)
    path.write_bytes(archive)
    return path
