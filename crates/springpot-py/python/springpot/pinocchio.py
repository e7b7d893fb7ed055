"""Elements between frames of a Pinocchio model: generalized forces and their tangents.

    elements = springpot.pinocchio.Elements(model, [
        {"name": "strut", "from": "universe", "to": {"frame": "tool0", "point": [0, 0, 0.05]}, "rest_length": "42 cm",
         "law": "springpot", "parameters": {"c": "50 N*s^alpha/m", "alpha": 0.4}},
    ])
    elements.begin(q)
    Q, dQ_dq, dQ_dv = elements.evaluate(t, h, q_next, v_next)
    elements.commit()

`pip install springpot[pinocchio]` brings Pinocchio.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._elements import Inputs, Signal, described
from ._errors import RunError
from ._springpot import Bank

__all__ = ["Elements"]

Array: TypeAlias = NDArray[np.float64]

# Their motion subspace turns with their own coordinates, which ∂J/∂q = ω × J leaves out.
_TURNING = ("SphericalZYX", "Universal", "Ellipsoid", "Composite", "Mimic")


def _engine() -> Any:
    try:
        return importlib.import_module("pinocchio")
    except ImportError as error:
        raise ImportError("springpot.pinocchio needs Pinocchio: pip install springpot[pinocchio]") from error


@dataclass(frozen=True)
class _End:
    """A point on a joint's body, in the joint's frame, m."""

    joint: int
    point: Array


@dataclass(frozen=True)
class _Course:
    """Lengths, m, of all elements at one (q, v): rates, gradients ∂l/∂q (n, nv), and ∂²l/∂q² (n, nv, nv), perturbed coordinate last."""

    lengths: Array
    rates: Array
    gradients: Array
    curvatures: Array


class Elements:
    """Elements between frames of a Pinocchio model, with their memories, for anybody's integrator.

        l = |d|, d = r_to − r_from (world), x = l − l0, x' = ∂l/∂q·v, Q = −Σ F ∂l/∂q

    with F the force that the law gives for the history of x: N, positive in tension. Q goes where actuator forces go:
    M a + b(q, v) = tau + Q. Tangents are along ``pinocchio.integrate(model, q, δ)``; ∂Q/∂q has the geometric part −F ∂²l/∂q² and that of x', too.

    Args:
        model: ``pinocchio.Model``; it is not changed.
        elements: dicts ``{"name", "from": end, "to": end, "rest_length", "inputs", …}`` with the law as in :class:`springpot.Bank`:
            ``"law"`` (a name or a :class:`springpot.Law`) or ``"network"``, ``"parameters"``, ``"derivative"``. An end is the name of a
            frame (``"universe"`` is the world), or ``{"frame": name, "point": [x, y, z]}``, m, in the frame's axes. ``rest_length`` is l0,
            m or a text, or ``"start"``: the length in :meth:`begin`. ``inputs`` are numbers, texts with a unit, or functions of t, s, taken
            at the nodes.
        nodes, form, motion, tolerance, step, horizon: as in :class:`springpot.Bank`. With ``nodes="end"`` q and v are those at t + h; with
            ``"radau"`` they are those at its three nodes, one row for each.

    Raises:
        ImportError: Pinocchio is not there.
        ValueError: no such frame, law, key, parameter or input; a value outside its range, or of another dimension; a joint whose axes turn
            with its own coordinates (spherical ZYX, universal, ellipsoid, composite, mimic).
    """

    def __init__(
        self,
        model: Any,
        elements: Sequence[Mapping[str, Any]],
        *,
        nodes: str = "end",
        form: str | None = None,
        motion: str = "sought",
        tolerance: float = 1e-8,
        step: float | str | None = None,
        horizon: float | str | None = None,
    ) -> None:
        self._engine, self._model = _engine(), model
        for name, joint in zip(model.names, model.joints):
            if any(kind in joint.shortname() for kind in _TURNING):
                raise ValueError(f'joint "{name}" is a {joint.shortname()}, whose axes turn with its own coordinates: there are no tangents for it')
        self._data = model.createData()
        self._elements = tuple(described(elements))
        self._ends = [(_end(model, e.name, e.start), _end(model, e.name, e.end)) for e in self._elements]
        self.bank = Bank(
            [e.law for e in self._elements], nodes=nodes, form=form, motion=motion, tolerance=tolerance, step=step, horizon=horizon
        )
        self._inputs = Inputs(self._elements, self.bank.inputs)
        self._is_start = np.array([e.rest_length is None for e in self._elements], dtype=bool)
        self._rest_lengths = np.array([e.rest_length or 0.0 for e in self._elements])
        self._forces = np.full(len(self._elements), np.nan)
        self._lengths = np.full(len(self._elements), np.nan)
        # Columns of one joint turn together; of two joints on a chain the later column turns with the earlier one.
        joint_of = np.empty(model.nv, dtype=np.intp)
        for joint, first, count in zip(range(model.njoints), model.idx_vs, model.nvs):
            joint_of[first : first + count] = joint
        self._turns_later = joint_of[None, :] <= joint_of[:, None]

    def __len__(self) -> int:
        return len(self._elements)

    def __repr__(self) -> str:
        return f"Elements({', '.join(self.names)})"

    @property
    def names(self) -> list[str]:
        """Names of the elements, in the order of all arrays."""
        return [element.name for element in self._elements]

    @property
    def rest_lengths(self) -> Array:
        """l0, shape ``(n,)``, m."""
        return self._rest_lengths.copy()

    @property
    def lengths(self) -> Array:
        """l at the last node that was evaluated, shape ``(n,)``, m."""
        return self._lengths.copy()

    @property
    def forces(self) -> Array:
        """F there, shape ``(n,)``, N, positive in tension."""
        return self._forces.copy()

    def begin(self, q: ArrayLike, v: ArrayLike | None = None) -> None:
        """Goes to t = 0; whatever was is forgotten.

        Args:
            q: shape ``(nq,)``. v: shape ``(nv,)``; 0 where left out.
        """
        at = np.zeros(self._model.nv) if v is None else _row(v, self._model.nv, "v")
        course = self._course(_row(q, self._model.nq, "q"), at, 0.0, curved=False)
        self._rest_lengths = np.where(self._is_start, course.lengths, self._rest_lengths)
        self.bank.begin(course.lengths - self._rest_lengths, course.rates, self._inputs.at(0.0))
        self._lengths = course.lengths

    def evaluate(self, t: float, h: float, q: ArrayLike, v: ArrayLike) -> tuple[Array, Array, Array]:
        """Generalized forces of a step from t to t + h, at its nodes, and their tangents; pure.

        Args:
            t: s. h: s, positive.
            q: at the nodes, shape ``(nq,)`` with one node, else ``(nodes, nq)``. v: there, ``(nv,)`` or ``(nodes, nv)``.

        Returns:
            Q, shape ``(nv,)``, N or N·m; ∂Q/∂q and ∂Q/∂v, shape ``(nv, nv)``, force first. With several nodes ``(nodes, nv)`` and
            ``(nodes, nodes, nv, nv)``: ``dQ_dq[i, j]`` is that of Q at node i by q at node j.

        Raises:
            ValueError: wrong shapes, numbers that are not finite, before :meth:`begin`.
            RunError: an element has no length, or an input breaks a rule of its law.
        """
        s, nv = len(self.bank.nodes), self._model.nv
        many = s > 1
        positions = _rows(q, s, self._model.nq, "q")
        velocities = _rows(v, s, nv, "v")
        times = t + h * self.bank.nodes
        courses = [self._course(*at) for at in zip(positions, velocities, times)]
        strokes = np.stack([course.lengths - self._rest_lengths for course in courses], axis=1)
        rates = np.stack([course.rates for course in courses], axis=1)
        force, by_stroke, by_rate = self.bank.evaluate(t, h, strokes, rates, self._inputs.over(times))
        generalized, by_q, by_v = np.zeros((s, nv)), np.zeros((s, s, nv, nv)), np.zeros((s, s, nv, nv))
        for i, here in enumerate(courses):
            generalized[i] = -force[:, i] @ here.gradients
            by_q[i, i] = -np.einsum("e,ebk->bk", force[:, i], here.curvatures)
            for j, there in enumerate(courses):
                rate_by_q = np.einsum("b,ebk->ek", velocities[j], there.curvatures)
                force_by_q = by_stroke[:, i, j, None] * there.gradients + by_rate[:, i, j, None] * rate_by_q
                by_q[i, j] -= here.gradients.T @ force_by_q
                by_v[i, j] -= here.gradients.T @ (by_rate[:, i, j, None] * there.gradients)
        self._forces, self._lengths = force[:, -1], courses[-1].lengths
        return (generalized, by_q, by_v) if many else (generalized[0], by_q[0, 0], by_v[0, 0])

    def commit(self) -> None:
        """Takes the step that was evaluated last into the past."""
        self.bank.commit()

    def state(self) -> tuple[Array, Array]:
        """All that outlasts a step: rest lengths, and the state of the bank."""
        return self._rest_lengths.copy(), self.bank.state()

    def set_state(self, state: tuple[Array, Array]) -> None:
        """Goes on from a :meth:`state` of the same elements, to the last bit.

        Raises:
            ValueError: it is one of other elements.
        """
        rest_lengths, bank = state
        if np.shape(rest_lengths) != (len(self),):
            raise ValueError("the state is one of other elements")
        self.bank.set_state(bank)
        self._rest_lengths = np.array(rest_lengths, dtype=np.float64)

    def set_input(self, element: str, input: str, value: Signal) -> None:
        """A number in SI, a text with a unit, or a function of t, from the next evaluation on."""
        self._inputs.set(f"{element}.{input}", value)

    def _course(self, q: Array, v: Array, t: float, curved: bool = True) -> _Course:
        self._engine.computeJointJacobians(self._model, self._data, q)
        n, nv = len(self), self._model.nv
        lengths, gradients, curvatures = np.empty(n), np.empty((n, nv)), np.zeros((n, nv, nv))
        for e, (start, end) in enumerate(self._ends):
            (a, lin_a, ang_a), (b, lin_b, ang_b) = self._point(start), self._point(end)
            stretch = b - a
            lengths[e] = np.linalg.norm(stretch)
            if not lengths[e] > 0.0:
                raise RunError(f't = {t} s: element "{self._elements[e].name}" has no direction: its length is {lengths[e]} m', t=t)
            unit, relative = stretch / lengths[e], lin_b - lin_a
            gradients[e] = unit @ relative
            if curved:
                across = relative.T @ relative - np.outer(gradients[e], gradients[e])
                curvatures[e] = across / lengths[e] + self._turning(unit, lin_b, ang_b) - self._turning(unit, lin_a, ang_a)
        return _Course(lengths, gradients @ v, gradients, curvatures)

    def _point(self, end: _End) -> tuple[Array, Array, Array]:
        """Position, m, and linear and angular Jacobian, (3, nv), in world axes."""
        pin = self._engine
        jacobian = pin.getJointJacobian(self._model, self._data, end.joint, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
        # With one degree of freedom Pinocchio gives a vector.
        jacobian = np.reshape(jacobian, (6, self._model.nv))
        placement = self._data.oMi[end.joint]
        arm = placement.rotation @ end.point
        linear, angular = jacobian[:3], jacobian[3:]
        return placement.translation + arm, linear + np.cross(angular, arm, axisa=0, axisb=0, axisc=0), angular

    def _turning(self, unit: Array, linear: Array, angular: Array) -> Array:
        """u·∂J_b/∂q_k, shape (nv, nv): ω_k × J_b where k turns b, else ω_b × J_k."""
        turned: Array = np.einsum("cb,ck->bk", linear, np.cross(unit, angular, axisa=0, axisb=0, axisc=0))
        return np.where(self._turns_later, turned, turned.T)


def _end(model: Any, element: str, said: Any) -> _End:
    extra = set(said) - {"frame", "point"} if isinstance(said, Mapping) else set()
    if extra or (isinstance(said, Mapping) and "frame" not in said):
        raise ValueError(f'element "{element}": an end is the name of a frame, or {{"frame": name, "point": [x, y, z]}}')
    name, offset = (said["frame"], said.get("point", (0.0, 0.0, 0.0))) if isinstance(said, Mapping) else (said, (0.0, 0.0, 0.0))
    if not model.existFrame(str(name)):
        known = ", ".join(frame.name for frame in model.frames)
        raise ValueError(f'element "{element}": there is no frame "{name}"; there are {known}')
    point = np.array(offset, dtype=np.float64)
    if point.shape != (3,) or not np.isfinite(point).all():
        raise ValueError(f'element "{element}": point is {offset}; it must be three finite numbers')
    frame = model.frames[model.getFrameId(str(name))]
    return _End(int(frame.parentJoint), frame.placement.act(point))


def _row(value: ArrayLike, size: int, name: str) -> Array:
    array = np.asarray(value, dtype=np.float64)
    if array.shape != (size,):
        raise ValueError(f"{name} has shape {array.shape}; it must have shape ({size},)")
    if not np.isfinite(array).all():
        raise ValueError(f"{name} is {array}; it must be finite")
    return array


def _rows(value: ArrayLike, nodes: int, size: int, name: str) -> list[Array]:
    array = np.asarray(value, dtype=np.float64)
    if nodes == 1:
        return [_row(array, size, name)]
    if array.shape != (nodes, size):
        raise ValueError(f"{name} has shape {array.shape}; it must have shape ({nodes}, {size})")
    return [_row(row, size, name) for row in array]
