"""A bank behind an engine that asks for forces whenever it likes, and tells nobody when a step is accepted."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from ._springpot import Bank

Array: TypeAlias = NDArray[np.float64]
Flags: TypeAlias = NDArray[np.bool_]

# As good as 0 where a force right after the start is asked, s: no step of an engine is shorter.
_AT_ONCE = 1e-150


@dataclass(frozen=True)
class Place:
    """Strokes, rates (n,) and inputs at t, and the size of the step that the engine takes from there."""

    t: float
    h: float
    strokes: Array
    rates: Array
    inputs: dict[str, float | str]


@dataclass(frozen=True)
class Moment:
    """A bank right after a commit: at ``t``, before a step that is to be of size ``h``."""

    t: float
    h: float
    bank: Array


@dataclass(frozen=True)
class State:
    """All that outlasts a call, to go on from; it can be pickled.

    Attributes:
        base: the last commit.
        before: the one before it, or ``None``.
        latest: the last call, or ``None``.
        begun_at: s; ``None`` before the start.
        forces: of the last call, shape ``(n,)``, N.
        rest_lengths: shape ``(n,)``, m.
    """

    base: Moment | None
    before: Moment | None
    latest: Place | None
    begun_at: float | None
    forces: Array
    rest_lengths: Array


class Behind:
    """The step behind an engine's clock.

    A call at t is answered from the memory of all that was before ``base`` and the step from there to t, which counts as not yet accepted.
    It is accepted, once, when a call comes from beyond its end: with what the last call at its end told. Stages within a step (Runge–Kutta)
    are therefore steps from ``base`` that nobody accepts, and a call that repeats a time takes the place of the one before. One step can be
    taken back: a stage may have had it accepted before the engine asked for its start again.

    Times that do not follow — earlier ones, or ones beyond the next step's end — begin anew.
    """

    def __init__(self, bank: Bank, jumping: Flags) -> None:
        self.bank = bank
        # Which elements jump at the start where their stroke is not 0: those with the Riemann–Liouville derivative.
        self._jumping = jumping
        self.reset()

    def of(self, bank: Bank) -> Behind:
        """The same for another bank, before its start."""
        return Behind(bank, self._jumping)

    def reset(self) -> None:
        """The next call begins anew."""
        self._base: Moment | None = None
        self._before: Moment | None = None
        self.latest: Place | None = None
        self.begun_at: float | None = None
        self.forces: Array = np.full(len(self.bank), np.nan)
        # What the bank was asked last, as far as it still knows.
        self._asked: Place | None = None

    def begins(self, t: float) -> bool:
        """Whether a call at t begins anew."""
        base, latest = self._base, self.latest
        if base is None or latest is None or t < base.t:
            return True
        if t == base.t:
            return self._before is None
        slack = 1e-9 * base.h
        if t <= base.t + base.h + slack:
            return False
        return abs(latest.t - base.t - base.h) > slack or t > latest.t + latest.h * (1.0 + 1e-9)

    def evaluate(self, place: Place) -> Array:
        """Forces, shape ``(n,)``, N."""
        if self.begins(place.t):
            return self._begin(place)
        base = self._base
        assert base is not None
        if place.t == base.t:
            self._take_back()
        elif place.t > base.t + base.h * (1.0 + 1e-9):
            self._accept()
        self.forces, self.latest = self._ask(place), place
        return self.forces

    def energies(self) -> tuple[Array, Array, Array]:
        """Stored, dissipated and supplied, each ``(n,)``, J, at the time of the last call."""
        base, latest = self._base, self.latest
        if base is None or latest is None:
            nothing = np.full(len(self.bank), np.nan)
            return nothing, nothing, nothing
        if latest.t > base.t:
            self._ask(latest)
            self.bank.commit()
        found = self.bank.stored, self.bank.dissipated, self.bank.supplied
        self._load(base.bank)
        return found

    def state(self, rest_lengths: Array) -> State:
        return State(self._base, self._before, self.latest, self.begun_at, self.forces.copy(), rest_lengths.copy())

    def set_state(self, state: State) -> None:
        """Goes on from a state of the same elements.

        Raises:
            ValueError: it is one of other elements; nothing changes then.
        """
        if state.forces.shape != (len(self.bank),):
            raise ValueError("the state is one of other elements")
        if state.base is not None:
            self._load(state.base.bank)
        self._base, self._before, self.latest = state.base, state.before, state.latest
        self.begun_at, self.forces = state.begun_at, state.forces.copy()

    def _begin(self, place: Place) -> Array:
        # Until the next call nothing is known: what fails here leaves no half of a start.
        self.reset()
        self.bank.begin(place.strokes, place.rates, place.inputs)
        start = Moment(place.t, place.h, self.bank.state())
        forces = self._forces(0.0, _AT_ONCE, place)
        jumps = self._jumping & (place.strokes != 0.0)
        if jumps.any():
            # The force is infinite at once; its mean over the step is what an engine can take.
            forces = np.where(jumps, self._forces(0.0, place.h, place), forces)
        self._load(start.bank)
        self._base, self.latest = start, place
        self.begun_at, self.forces = place.t, forces
        return forces

    def _ask(self, place: Place) -> Array:
        assert self._base is not None and self.begun_at is not None
        return self._forces(self._base.t - self.begun_at, place.t - self._base.t, place)

    def _forces(self, t: float, h: float, place: Place) -> Array:
        self._asked = None
        forces: Array = self.bank.evaluate(t, h, place.strokes, place.rates, place.inputs)[0][:, 0]
        self._asked = place
        return forces

    def _load(self, state: Array) -> None:
        self._asked = None
        self.bank.set_state(state)

    def _accept(self) -> None:
        latest = self.latest
        assert latest is not None
        if self._asked is not latest:
            self._ask(latest)
        self.bank.commit()
        self._before, self._base = self._base, Moment(latest.t, latest.h, self.bank.state())

    def _take_back(self) -> None:
        assert self._before is not None
        self._load(self._before.bank)
        self._base, self._before = self._before, None
