"""Elements on a MuJoCo model, between its sites, through its passive-force callback.

    elements = springpot.mujoco.Elements(model, data, [
        {"name": "strut", "from": "base", "to": "tip", "rest_length": "42 cm",
         "law": "springpot", "parameters": {"c": "50 N*s^alpha/m", "alpha": 0.4}},
    ])
    for _ in range(1000):
        mujoco.mj_step(model, data)
    elements.disable()

`pip install springpot[mujoco]` brings MuJoCo. docs/ENGINES.md says what order to expect.
"""

from __future__ import annotations

import importlib
import weakref
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._behind import Array, Behind, Place, State
from ._elements import Inputs, Signal, described
from ._errors import RunError
from ._springpot import Bank

__all__ = ["Elements", "State"]

_active: dict[int, list[Elements]] = {}
"""By the address of the data that they act on."""

_previous: Any = None
"""The callback that was there before."""


def _engine() -> Any:
    try:
        return importlib.import_module("mujoco")
    except ImportError as error:
        raise ImportError("springpot.mujoco needs MuJoCo: pip install springpot[mujoco]") from error


def _callback(model: Any, data: Any) -> None:
    if callable(_previous):
        _previous(model, data)
    for elements in tuple(_active.get(data._address, ())):
        elements._act(model, data)


class Elements:
    """Elements between sites of a MuJoCo model, with their memories, for one ``MjData``.

    They act from now on until :meth:`disable`, the end of a ``with`` block, or the end of ``data``: in every ``mj_step``, ``mj_forward``,
    ``mj_inverse`` and whatever else asks for passive forces,

        l = |d|, d = r_to − r_from (world), x = l − l0, g = (d/l)ᵀ(J_to − J_from), x' = g·qvel, ``qfrc_passive`` += −F g

    with F the force that the law gives for the history of x: N, positive in tension.

    A step enters the memory once, when the engine asks from beyond its end; stages of RK4, ``mj_forward``, finite differences by ``mjd_*``
    and the like change nothing. Where time goes back, or on to where no step of ``opt.timestep`` leads, memories begin anew with strokes
    held at what they are there; call :meth:`reset` where a state is set at the time that ``data`` has already, or :meth:`set_state` to go
    on from one that was kept.

    Args:
        model: ``MjModel``. data: ``MjData``; other data of the model have no elements unless :meth:`copy` gives them some.
        elements: dicts ``{"name", "from": site, "to": site, "rest_length", "inputs", …}`` with the law as in :class:`springpot.Bank`:
            ``"law"`` (a name or a :class:`springpot.Law`) or ``"network"``, ``"parameters"``, ``"derivative"``. Names default to "0", "1",
            …. ``rest_length`` is l0, m or a text, or ``"start"``: the length where memories begin. ``inputs`` are numbers, texts with a
            unit, or functions of ``data.time``, s; they hold over a step.
        form: ``"strokes"``: the memory sees x, of order 2 − alpha; ``"rates"``: it sees x', of order 3 − alpha. Left out: rates with RK4,
            else strokes. A mocap body moves without velocity: take strokes there.
        tolerance, step, horizon: as in :class:`springpot.Bank`; ``step`` is the timestep where left out.

    MuJoCo's implicit integrators do not see the tangents of a callback: elements are held explicitly. A springpot is stable for
    c h^(2 − alpha) < 1.5 m with 1/m = g M⁻¹ gᵀ, a spring for k h² < 4 m.

    While any elements act, MuJoCo refuses to load models ("engine error: Python exception raised"), as it does under every Python callback:
    load before, or after :meth:`disable`. With spring *and* damper forces disabled in ``opt.disableflags`` MuJoCo asks for no passive
    forces at all.

    Errors come through ``mj_step`` and its kind as the exceptions that they are, out of functions for inputs too; memories are as before
    then. MuJoCo leaves its step in the middle: with RK4 ``data`` may hold a stage, so reset it or set its state. Until ``mj_resetData``
    each exception costs some of its arena. Before MuJoCo 4 functions for inputs may not call MuJoCo and then raise: that ends the process.

    Raises:
        ImportError: MuJoCo is not there.
        ValueError: no such site, law, key, parameter or input; a value outside its range, or of another dimension.
        RunError: from ``mj_step``: an element has no length, or an input breaks a rule of its law.
    """

    def __init__(
        self,
        model: Any,
        data: Any,
        elements: Sequence[Mapping[str, Any]],
        *,
        form: str | None = None,
        tolerance: float = 1e-8,
        step: float | str | None = None,
        horizon: float | str | None = None,
    ) -> None:
        mujoco = _engine()
        if form is None:
            form = "rates" if model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4 else "strokes"
        self._elements = tuple(described(elements))
        self._settings: dict[str, Any] = {
            "form": form,
            "tolerance": tolerance,
            "step": step if step is not None else float(model.opt.timestep),
            "horizon": horizon,
        }
        self._sites = [(_site(model, e.name, e.start), _site(model, e.name, e.end)) for e in self._elements]
        bank = Bank([e.law for e in self._elements], nodes="end", **self._settings)
        self._inputs = Inputs(self._elements, bank.inputs)
        jumping = [e.law.get("derivative") == "riemann-liouville" for e in self._elements]
        self._behind = Behind(bank, np.array(jumping, dtype=bool))
        self._is_start = np.array([e.rest_length is None for e in self._elements], dtype=bool)
        self._rest_lengths = np.array([e.rest_length or 0.0 for e in self._elements])
        self._engine, self._model, self._data = mujoco, model, weakref.ref(data)
        self._address = int(data._address)
        self._movers = [(_movers(model, start), _movers(model, end)) for start, end in self._sites]
        # The data may end first; its address may then be that of others.
        weakref.finalize(data, _forget, self._address).atexit = False
        self.enable()

    def __enter__(self) -> Elements:
        self.enable()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.disable()

    def __len__(self) -> int:
        return len(self._elements)

    def __repr__(self) -> str:
        return f"Elements({', '.join(self.names)}; {'enabled' if self.enabled else 'disabled'})"

    def __getitem__(self, name: str) -> dict[str, float]:
        """Length, stroke, rate, force and energies of an element, as the properties have them."""
        if name not in self.names:
            raise KeyError(f'there is no element "{name}"; there are {", ".join(self.names)}')
        k = self.names.index(name)
        columns = {
            "length": self.lengths,
            "stroke": self.strokes,
            "rate": self.rates,
            "force": self.forces,
            "stored": self.stored,
            "dissipated": self.dissipated,
            "supplied": self.supplied,
        }
        return {column: float(values[k]) for column, values in columns.items()}

    def enable(self) -> None:
        """From now on they act; callbacks that others have set are called first."""
        global _previous
        if self._data() is None:
            raise RunError("the data of these elements is gone")
        own = _active.setdefault(self._address, [])
        if self not in own:
            own.append(self)
        now = self._engine.get_mjcb_passive()
        if now is not _callback:
            _previous = now
            self._engine.set_mjcb_passive(_callback)

    def disable(self) -> None:
        """From now on they do not act; the memory stays. When nobody acts any more, the callback of before is put back."""
        _drop(self._address, self)

    @property
    def enabled(self) -> bool:
        """Whether they act; not where somebody has set another passive-force callback since."""
        return self in _active.get(self._address, ()) and self._engine.get_mjcb_passive() is _callback

    @property
    def names(self) -> list[str]:
        """Names of the elements, in the order of all arrays."""
        return [element.name for element in self._elements]

    @property
    def t(self) -> float:
        """``data.time`` of the last call, s, which all below is about; NaN before the first.

        As with MuJoCo's own results that is the start of the last ``mj_step``, or now after ``mj_forward``.
        """
        return self._behind.latest.t if self._behind.latest is not None else float("nan")

    @property
    def begun_at(self) -> float | None:
        """``data.time`` where memories began, s; ``None`` before the first call."""
        return self._behind.begun_at

    @property
    def rest_lengths(self) -> Array:
        """l0, shape ``(n,)``, m; of ``"start"`` NaN before the first call."""
        return np.where(self._is_start & (self._behind.begun_at is None), np.nan, self._rest_lengths)

    @property
    def lengths(self) -> Array:
        """l, shape ``(n,)``, m."""
        return self.strokes + self.rest_lengths

    @property
    def strokes(self) -> Array:
        """x = l − l0, shape ``(n,)``, m."""
        latest = self._behind.latest
        return latest.strokes.copy() if latest is not None else np.full(len(self), np.nan)

    @property
    def rates(self) -> Array:
        """x', shape ``(n,)``, m/s."""
        latest = self._behind.latest
        return latest.rates.copy() if latest is not None else np.full(len(self), np.nan)

    @property
    def forces(self) -> Array:
        """F, shape ``(n,)``, N, positive in tension."""
        return self._behind.forces.copy()

    @property
    def stored(self) -> Array:
        """Stored energy, shape ``(n,)``, J; NaN where unknown."""
        return self._behind.energies()[0]

    @property
    def dissipated(self) -> Array:
        """Energy dissipated since memories began, shape ``(n,)``, J."""
        return self._behind.energies()[1]

    @property
    def supplied(self) -> Array:
        """Energy supplied by inputs since memories began, shape ``(n,)``, J."""
        return self._behind.energies()[2]

    def set_input(self, element: str, input: str, value: Signal) -> None:
        """A number in SI, a text with a unit, or a function of ``data.time``, from the next call on."""
        self._inputs.set(f"{element}.{input}", value)

    def reset(self) -> None:
        """Memories begin anew at the next call."""
        self._behind.reset()

    def state(self) -> State:
        """What to keep beside a copy of ``data``: can be pickled; without functions for inputs."""
        return self._behind.state(self._rest_lengths)

    def set_state(self, state: State) -> None:
        """Goes on, to the last bit, from a :meth:`state` of the same elements, ``data`` being what it was then.

        Raises:
            ValueError: it is one of other elements.
        """
        self._behind.set_state(state)
        self._rest_lengths = state.rest_lengths.copy()

    def copy(self, data: Any) -> Elements:
        """The same elements with the same past for other data of the model, say ``copy.copy(data)``."""
        other = object.__new__(Elements)
        other.__dict__.update(self.__dict__)
        bank = Bank([e.law for e in self._elements], nodes="end", **self._settings)
        other._inputs, other._behind = self._inputs.copy(), self._behind.of(bank)
        other._data, other._address = weakref.ref(data), int(data._address)
        other.set_state(self.state())
        weakref.finalize(data, _forget, other._address).atexit = False
        other.enable()
        return other

    def _act(self, model: Any, data: Any) -> None:
        if model._address != self._model._address:
            raise RunError("the data is stepped with another model than its elements were made for", t=float(data.time))
        n, t = len(self), float(data.time)
        lengths, gradients = np.empty(n), np.zeros((n, model.nv))
        for e, (start, end) in enumerate(self._sites):
            first, last = data.site_xpos[start], data.site_xpos[end]
            stretch = last - first
            lengths[e] = np.linalg.norm(stretch)
            if not lengths[e] > 0.0:
                raise RunError(f't = {t} s: element "{self._elements[e].name}" has no direction: its length is {lengths[e]} m', t=t)
            direction = stretch / lengths[e]
            for sign, point, movers in ((-1.0, first, self._movers[e][0]), (1.0, last, self._movers[e][1])):
                gradients[e, movers.dofs] += sign * movers.along(data, point, direction)
        if self._behind.begins(t):
            self._rest_lengths = np.where(self._is_start, lengths, self._rest_lengths)
        strokes, rates = lengths - self._rest_lengths, gradients @ data.qvel
        place = Place(t, float(model.opt.timestep), strokes, rates, self._inputs.at(t))
        data.qfrc_passive[:] -= self._behind.evaluate(place) @ gradients


@dataclass(frozen=True)
class _Movers:
    """The degrees of freedom that move a body, and the root of its tree."""

    dofs: NDArray[np.intp]
    root: int

    def along(self, data: Any, point: Array, direction: Array) -> Array:
        """Their columns of the point's Jacobian along a direction: what ``mj_jac`` does.

        Functions of MuJoCo that are called in its callback take away, before version 4, its way to bring an exception out.
        """
        arm = point - data.subtree_com[self.root]
        columns = data.cdof[self.dofs]
        found: Array = columns[:, 3:] @ direction + columns[:, :3] @ _cross(arm, direction)
        return found


def _cross(a: Array, b: Array) -> Array:
    """a × b; NumPy's own takes longer than a step of a small arm."""
    (x, y, z), (u, v, w) = a.tolist(), b.tolist()
    return np.array([y * w - z * v, z * u - x * w, x * v - y * u])


def _movers(model: Any, site: int) -> _Movers:
    body = int(model.site_bodyid[site])
    root = int(model.body_rootid[body])
    while body > 0 and model.body_dofnum[body] == 0:
        body = int(model.body_parentid[body])
    dofs: list[int] = []
    dof = int(model.body_dofadr[body] + model.body_dofnum[body] - 1) if body > 0 else -1
    while dof >= 0:
        dofs.append(dof)
        dof = int(model.dof_parentid[dof])
    return _Movers(np.array(dofs, dtype=np.intp), root)


def _site(model: Any, element: str, name: Any) -> int:
    mujoco = _engine()
    known = [model.site(k).name for k in range(model.nsite)]
    found = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, str(name))
    if found < 0:
        raise ValueError(f'element "{element}": there is no site "{name}"; there are {", ".join(filter(None, known)) or "none with a name"}')
    return int(found)


def _drop(address: int, elements: Elements | None) -> None:
    global _previous
    rest = [own for own in _active.get(address, ()) if elements is not None and own is not elements]
    if rest:
        _active[address] = rest
    else:
        _active.pop(address, None)
    mujoco = _engine()
    if not _active and mujoco.get_mjcb_passive() is _callback:
        mujoco.set_mjcb_passive(_previous)
        _previous = None


def _forget(address: int) -> None:
    _drop(address, None)
