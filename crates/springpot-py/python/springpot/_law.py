"""Laws with their parameters, Prony series, data sheets."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _springpot
from ._springpot import Law, Prony

if TYPE_CHECKING:
    from ._springpot import LawRow

Number: TypeAlias = "float | str"


def laws() -> list[LawRow]:
    """All laws that have a name: rows with ``name``, ``equation``, ``source``, ``parameters`` and ``inputs``.

    >>> import springpot as sp
    >>> [row["equation"] for row in sp.laws() if row["name"] == "springpot"]
    ['F = c·D^alpha x']
    """
    return _springpot.laws()


def law(name: str, *, derivative: str = "caputo", **parameters: Any) -> Law:
    """A law of the catalog with its parameters, each SI or a text with a unit.

    >>> import springpot as sp
    >>> rubber = sp.law("fractional-kelvin-voigt", k="2 N/mm", c=50.0, alpha=0.3)
    >>> rubber.parameters
    {'k': 2000.0, 'c': 50.0, 'alpha': 0.3}
    >>> rubber.equation
    'F = k·x + c·D^alpha x'

    Raises:
        ValueError: no such law or parameter, a value outside its range, a unit of another dimension.
    """
    return Law({"law": name, "parameters": parameters, "derivative": derivative})


def network(text: str, *, derivative: str = "caputo", parameters: Mapping[str, Any] | None = None, **more: Any) -> Law:
    """A network of leaves in ``series(…)`` and ``parallel(…)``; arguments of the leaves are names of parameters.

    A parameter that is the file of a leaf ``table(file)`` is a tuple of strokes, m, and forces, N, here.

    >>> import springpot as sp
    >>> mount = sp.network("series(spring(k0), parallel(springpot(c, alpha), dashpot(eta)))", k0=9e3, c=40, alpha=0.4, eta=3)
    >>> mount.leaves
    ['spring1', 'springpot1', 'dashpot1']
    """
    return Law({"network": text, "parameters": {**(parameters or {}), **more}, "derivative": derivative})


def prony(
    law: Law,
    times: tuple[Number, Number] | None = None,
    *,
    band: tuple[Number, Number] | None = None,
    rtol: float = 1e-4,
    slowest: str = "relaxes",
) -> Prony:
    """The shortest Prony series that stands for a law of springs and springpots, with a verified bound.

    Args:
        law: linear and without inputs; for a bare springpot ``sp.law("springpot", …)``.
        times: from and to, s: the bound is on G(t).
        band: from and to, rad/s or texts such as ``"10 Hz"``: the bound is on G*(ω).
        rtol: the bound, relative, 1e-11 … 0.1.
        slowest: what relaxes more slowly than the window sees ``"relaxes"``, or ``"stays"`` as a spring.

    >>> import springpot as sp
    >>> series = sp.prony(sp.law("springpot", c=50.0, alpha=0.5), times=("1 ms", 10.0), rtol=1e-4)
    >>> series.error <= 1e-4 and len(series) < 20
    True
    """
    return _springpot.prony(law, times, band=band, rtol=rtol, slowest=slowest)


def datasheet(
    data: Iterable[tuple[str, Number, Number]],
    law: str | None = None,
    *,
    area: Number | None = None,
    length: Number | None = None,
) -> tuple[Law, float]:
    """The law that values of a data sheet determine, and the largest relative deviation from them.

    Args:
        data: tuples of a name (``tan_delta``, ``stiffness``, ``storage``, ``loss``, ``damping``), its value, and the frequency: rad/s, a text
            such as ``"10 Hz"``, or 0 for a static value. Values without a unit are N/m, N·s/m, or numbers; the loss factor may be told as the
            angle, ``"17 deg"``.
        law: the name of the law; left out: the one of the form that such data determine.
        area, length: the sample that moduli in Pa were measured on, m² and m: the stiffness is E·A/L.

    >>> import springpot as sp
    >>> rubber, deviation = sp.datasheet([("tan_delta", 0.3, "10 Hz"), ("stiffness", "5 kN/m", "10 Hz")])
    >>> rubber.name, round(rubber.parameters["alpha"], 4), deviation < 1e-12
    ('springpot', 0.1855, True)
    >>> again, _ = sp.datasheet([("tan_delta", 0.3, "10 Hz"), ("stiffness", "0.125 MPa", "10 Hz")], area="4 cm^2", length="10 mm")
    >>> again.parameters == rubber.parameters
    True
    """
    return _springpot.datasheet(list(data), law, area=area, length=length)


def fit(
    omega: ArrayLike,
    modulus: ArrayLike,
    law: str = "fractional-kelvin-voigt",
    *,
    area: Number | None = None,
    length: Number | None = None,
) -> tuple[Law, float, dict[str, float | None]]:
    """A law fitted to a measured modulus over the frequency.

    Args:
        omega: rad/s, shape ``(N,)``.
        modulus: K* = K' + iK'', N/m, complex, shape ``(N,)``; with a sample E* = E' + iE'', Pa.
        law: its name: any linear one without inputs, such as ``springpot``, ``fractional-kelvin-voigt``, ``zener``, ``fractional-maxwell``.
        area, length: of the sample, m² and m: the stiffness is E*·A/L.

    Returns:
        The law, the root mean square of its relative deviations, and one standard deviation of each parameter (``None`` for one at an end of
        its range).
    """
    measured = np.asarray(modulus, dtype=np.complex128)
    return _springpot.fit_modulus(omega, measured.real, measured.imag, law, area, length)


@dataclass(frozen=True, eq=False, repr=False)
class Master:
    """A master curve: what :func:`springpot.master` found.

    Attributes:
        reference: T_ref, K.
        T: temperatures of the curves, K, coldest first, shape ``(M,)``.
        log10_a_T, log10_b_T: their shifts, shape ``(M,)``: E*(f·a_T; T_ref) = b_T·E*(f; T).
        sd, sd_b: their standard deviations from T_ref on, shape ``(M,)``.
        curve: ``frequency`` (reduced), ``storage``, ``loss`` and ``T`` of all rows, shape ``(N,)``, lowest frequency first.
        wlf: ``C1``, ``C2`` (K), ``T_ref``, ``sd`` of both, their ``correlation``, ``rms`` of what it misses a step by in decades, ``bic``;
            ``None`` with two temperatures.
        arrhenius: ``energy`` (J/mol), ``T_ref``, ``sd``, ``rms``, ``bic``.
        shift: that of the two which BIC prefers, as the table ``shift`` of an element.
        scatter: of storage and loss about a common curve, as shares of abs(E*).
    """

    reference: float
    T: NDArray[np.float64]
    log10_a_T: NDArray[np.float64]
    sd: NDArray[np.float64]
    log10_b_T: NDArray[np.float64]
    sd_b: NDArray[np.float64]
    curve: dict[str, NDArray[np.float64]]
    wlf: dict[str, Any] | None
    arrhenius: dict[str, Any]
    shift: dict[str, Any]
    scatter: tuple[float, float]

    def __repr__(self) -> str:
        return f"Master({len(self.T)} temperatures, {len(self.curve['T'])} rows, shift={self.shift})"


def master(
    frequency: ArrayLike,
    storage: ArrayLike,
    loss: ArrayLike,
    T: ArrayLike,
    reference: Number,
    *,
    vertical: bool = False,
) -> Master:
    """Shifts a modulus that was measured at several temperatures to one master curve, as ``springpot master`` does.

    Args:
        frequency: Hz, or rad/s: the curve is in the same, shape ``(N,)``.
        storage, loss: E' and E'', Pa or N/m, shape ``(N,)``.
        T: K, shape ``(N,)``; temperatures within 2 K of the next one are one curve.
        reference: T_ref, K or a text such as ``"20 degC"``, among the temperatures or between them.
        vertical: whether moduli are shifted too.

    >>> import numpy as np, springpot as sp
    >>> f, T = (a.ravel() for a in np.meshgrid(np.logspace(-1, 2, 16), 273.15 + np.arange(0.0, 45.0, 5.0)))
    >>> a_T = 10 ** (-12 * (T - 293.15) / (80 + T - 293.15))
    >>> E = sp.law("fractional-zener", k_e=2e6, k_m=1.5e9, c=4e7, alpha=0.5).modulus(2 * np.pi * f * a_T)
    >>> found = sp.master(f, E.real, E.imag, T, "20 degC")
    >>> round(found.wlf["C1"], 1), round(found.wlf["C2"])
    (12.0, 80)

    Raises:
        ValueError: numbers that are not positive, one temperature alone, a reference outside of them.
        RunError: two neighbours that do not overlap, or are too flat to be shifted; it says which.
    """
    found = _springpot.master(frequency, storage, loss, T, reference, vertical)
    chosen = {name: value for name, value in found["chosen"].items() if name in ("kind", "C1", "C2", "energy", "T_ref")}
    return Master(
        reference=found["chosen"]["T_ref"],
        **{name: found[name] for name in ("T", "log10_a_T", "sd", "log10_b_T", "sd_b", "curve", "wlf", "arrhenius")},
        shift=chosen,
        scatter=tuple(found["scatter"]),
    )
