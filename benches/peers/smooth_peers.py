"""The cases of smooth_runs.py in other programs: MuJoCo, exudyn, and SciPy over Pinocchio's articulated-body algorithm.

All build the tree of bodies that the scenario tells; a robot from URDF is read by Pinocchio. Its joints beyond the seventh, fingers of which one
mimics the other, are held at zero, where their symmetry keeps them. Limits and contacts are off, as in a forward run of springpot.
A rival is a dictionary of its methods. Models are built before the clock runs.
"""

import importlib.util
import math
import time
import tomllib
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

GRAVITY = [0.0, 0.0, -9.81]
RIVALS = ["MuJoCo", "exudyn", "SciPy + Pinocchio"]
MISSING = [name for name in ("mujoco", "exudyn", "pinocchio", "scipy") if importlib.util.find_spec(name) is None]


class Body(NamedTuple):
    name: str
    parent: int  # -1 is the world
    rotation: np.ndarray  # of the joint's frame, to that of the parent
    origin: np.ndarray  # of the joint's frame in that of the parent, m
    prismatic: bool
    axis: np.ndarray
    mass: float
    com: np.ndarray
    inertia: np.ndarray  # about the centre of mass, kg m²
    damping: float


class Element(NamedTuple):
    ends: list  # two of (index of the body, point)
    rest: float
    k: float
    c: float


class Case(NamedTuple):
    bodies: list
    elements: list
    q: np.ndarray
    v: np.ndarray
    end: float


def number(value):
    if isinstance(value, str):
        value, unit = value.split()
        return float(value) * {"s": 1.0, "deg": math.pi / 180}[unit]
    return float(value)


def bodies_of_scenario(bodies):
    names = [body["name"] for body in bodies]
    for body in bodies:
        joint, inertia = body["joint"], body["inertia"]
        yield (
            joint["name"],
            Body(
                body["name"],
                names.index(body["parent"]) if "parent" in body else -1,
                np.eye(3),
                np.array(joint.get("origin", [0, 0, 0]), float),
                joint["kind"] == "prismatic",
                np.array(joint["axis"], float),
                body["mass"],
                np.array(body.get("com", [0, 0, 0]), float),
                np.diag([inertia["xx"], inertia["yy"], inertia["zz"]]),
                joint.get("damping", 0.0),
            ),
        )


def bodies_of_urdf(file):
    import pinocchio as pin

    full = pin.buildModelFromUrdf(file)
    damping = np.array(full.damping)
    model = pin.buildReducedModel(full, list(range(8, full.njoints)), pin.neutral(full))
    for k in range(1, model.njoints):
        link = next(f.name for f in full.frames if f.type == pin.FrameType.BODY and f.parentJoint == k)
        place, own = model.jointPlacements[k], model.inertias[k]
        frame = model.parents[k] - 1, place.rotation, place.translation
        yield model.names[k], Body(link, *frame, False, np.array([0.0, 0, 1]), own.mass, own.lever, own.inertia, damping[k - 1])


def read(text):
    scenario = tomllib.loads(text)
    robot = scenario["robot"]
    joints, bodies = zip(*(bodies_of_urdf(robot["urdf"]) if "urdf" in robot else bodies_of_scenario(robot["body"])))
    names = [body.name for body in bodies]
    elements = []
    for element in scenario["element"]:
        ends = [(-1 if end["body"] == "world" else names.index(end["body"]), np.array(end["point"])) for end in (element["from"], element["to"])]
        elements.append(Element(ends, element["rest_length"], element["parameters"]["k"], element["parameters"]["c"]))
    start = scenario["motion"]["start"]
    q, v = (np.array([number(start.get(of, {}).get(joint, 0.0)) for joint in joints]) for of in "qv")
    return Case(bodies, elements, q, v, number(scenario["time"]["end"]))


def mjcf(case):
    def words(values):
        return " ".join(repr(float(value)) for value in values)

    def body(k):
        own = case.bodies[k]
        i = own.inertia
        # The frame by its axes x and y.
        text = f'<body name="{k}" pos="{words(own.origin)}" xyaxes="{words([*own.rotation[:, 0], *own.rotation[:, 1]])}">'
        text += f'<joint name="{k}" type="{"slide" if own.prismatic else "hinge"}" axis="{words(own.axis)}" damping="{own.damping}"/>'
        full = words([i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2]])
        text += f'<inertial pos="{words(own.com)}" mass="{own.mass}" fullinertia="{full}"/>' + sites(k)
        return text + "".join(body(child) for child, other in enumerate(case.bodies) if other.parent == k) + "</body>"

    def sites(k):
        ends = ((f"e{n}{side}", point) for n, e in enumerate(case.elements) for side, (at, point) in enumerate(e.ends) if at == k)
        return "".join(f'<site name="{name}" pos="{words(point)}"/>' for name, point in ends)

    tendons = "".join(
        f'<spatial stiffness="{e.k}" damping="{e.c}" springlength="{e.rest}"><site site="e{n}0"/><site site="e{n}1"/></spatial>'
        for n, e in enumerate(case.elements)
    )
    roots = "".join(body(k) for k, own in enumerate(case.bodies) if own.parent < 0)
    return (
        f'<mujoco><compiler angle="radian"/><option gravity="{words(GRAVITY)}"><flag contact="disable" limit="disable"/></option>'
        f"<worldbody>{sites(-1)}{roots}</worldbody><tendon>{tendons}</tendon></mujoco>"
    )


class Method(NamedTuple):
    """A method: from a number of steps, or a tolerance, to (seconds of CPU, q at the end)."""

    by_steps: bool
    run: Callable

    def __call__(self, setting):
        return self.run(setting)


def mujoco_methods(case):
    import mujoco

    mujoco.set_mju_user_warning(lambda text: None)  # of steps that are too long: their errors tell
    model = mujoco.MjModel.from_xml_string(mjcf(case))
    places = [model.joint(str(k)).qposadr[0] for k in range(len(case.bodies))]

    def method(integrator):
        def run(steps):
            model.opt.integrator, model.opt.timestep = integrator, case.end / steps
            data = mujoco.MjData(model)
            data.qpos[places], data.qvel[places] = case.q, case.v
            begun = time.process_time()
            mujoco.mj_step(model, data, nstep=steps)
            return time.process_time() - begun, data.qpos[places]

        return Method(True, run)

    kinds = mujoco.mjtIntegrator
    return {"RK4": method(kinds.mjINT_RK4), "implicitfast": method(kinds.mjINT_IMPLICITFAST), "implicit": method(kinds.mjINT_IMPLICIT)}


def exudyn_methods(case):
    import exudyn as exu
    from exudyn import itemInterface as items

    kinds = [exu.JointType.RevoluteX, exu.JointType.RevoluteY, exu.JointType.RevoluteZ]
    axes = [int(np.argmax(body.axis)) for body in case.bodies]
    if any(body.prismatic or body.axis[axis] != 1 for body, axis in zip(case.bodies, axes)):
        return {}
    system = exu.SystemContainer().AddSystem()
    n = len(case.bodies)
    node = system.AddNode(
        items.NodeGenericODE2(
            referenceCoordinates=[0.0] * n, initialCoordinates=list(case.q), initialCoordinates_t=list(case.v), numberOfODE2Coordinates=n
        )
    )
    tree = system.AddObject(
        items.ObjectKinematicTree(
            nodeNumber=node,
            gravity=GRAVITY,
            jointTypes=[kinds[axis] for axis in axes],
            linkParents=[body.parent for body in case.bodies],
            jointTransformations=exu.Matrix3DList([body.rotation for body in case.bodies]),
            jointOffsets=exu.Vector3DList([body.origin for body in case.bodies]),
            linkInertiasCOM=exu.Matrix3DList([body.inertia for body in case.bodies]),
            linkCOMs=exu.Vector3DList([body.com for body in case.bodies]),
            linkMasses=[body.mass for body in case.bodies],
            jointDControlVector=[body.damping for body in case.bodies],
            jointPControlVector=[0.0] * n,
            jointPositionOffsetVector=[0.0] * n,
            jointVelocityOffsetVector=[0.0] * n,
        )
    )
    ground = system.AddObject(items.ObjectGround())
    for element in case.elements:
        ends = [
            system.AddMarker(
                items.MarkerBodyPosition(bodyNumber=ground, localPosition=point)
                if at < 0
                else items.MarkerKinematicTreeRigid(objectNumber=tree, linkNumber=at, localPosition=point)
            )
            for at, point in element.ends
        ]
        system.AddObject(items.ObjectConnectorSpringDamper(markerNumbers=ends, referenceLength=element.rest, stiffness=element.k, damping=element.c))
    system.Assemble()

    def method(kind, adaptive):
        def run(setting):
            settings = exu.SimulationSettings()
            settings.solutionSettings.writeSolutionToFile = False
            settings.timeIntegration.verboseMode = 0
            settings.timeIntegration.endTime = case.end
            settings.timeIntegration.automaticStepSize = adaptive
            if adaptive:
                settings.timeIntegration.numberOfSteps = 1
                settings.timeIntegration.initialStepSize = 1e-4
                settings.timeIntegration.relativeTolerance = settings.timeIntegration.absoluteTolerance = setting
            else:
                settings.timeIntegration.numberOfSteps = setting
            begun = time.process_time()
            system.SolveDynamic(settings, solverType=kind)
            return time.process_time() - begun, np.array(system.systemData.GetODE2Coordinates())

        return Method(not adaptive, run)

    solvers = exu.DynamicSolverType
    return {"RK44": method(solvers.RK44, False), "RK67": method(solvers.RK67, False), "DOPRI5": method(solvers.DOPRI5, True)}


def acceleration(case):
    """(t, [q, v]) ↦ [v, a] by Pinocchio's ABA, elements as forces on the joints' bodies."""
    import pinocchio as pin

    model = pin.Model()
    model.gravity.linear = np.array(GRAVITY)
    for k, body in enumerate(case.bodies):
        aligned = [pin.JointModelPX, pin.JointModelPY, pin.JointModelPZ] if body.prismatic else [pin.JointModelRX, pin.JointModelRY, pin.JointModelRZ]
        kinds = [kind for kind, axis in zip(aligned, np.eye(3)) if np.array_equal(axis, body.axis)]
        joint = kinds[0]() if kinds else (pin.JointModelPrismaticUnaligned if body.prismatic else pin.JointModelRevoluteUnaligned)(body.axis)
        model.addJoint(body.parent + 1, joint, pin.SE3(body.rotation, body.origin), str(k))
        model.appendBodyToJoint(k + 1, pin.Inertia(body.mass, body.com, body.inertia), pin.SE3.Identity())
    data, n = model.createData(), model.nv
    damping = np.array([body.damping for body in case.bodies])
    forces = [pin.Force.Zero() for _ in range(model.njoints)]

    def end(joint, point):
        place, velocity = data.oMi[joint], data.v[joint]
        return place.rotation @ point + place.translation, place.rotation @ (velocity.linear + np.cross(velocity.angular, point))

    def rate(_, state):
        q, v = state[:n], state[n:]
        pin.forwardKinematics(model, data, q, v)
        for force in forces:
            force.setZero()
        for element in case.elements:
            (a, at_a), (b, at_b) = element.ends
            (from_point, from_rate), (to_point, to_rate) = end(a + 1, at_a), end(b + 1, at_b)
            line = to_point - from_point
            length = math.sqrt(line @ line)
            line /= length
            pull = (element.k * (length - element.rest) + element.c * (line @ (to_rate - from_rate))) * line
            for joint, point, force in ((a + 1, at_a, pull), (b + 1, at_b, -pull)):
                own = data.oMi[joint].rotation.T @ force
                forces[joint] += pin.Force(own, np.cross(point, own))
        return np.concatenate([v, pin.aba(model, data, q, v, -damping * v, forces)])

    return rate


def scipy_methods(case, name):
    from scipy.integrate import solve_ivp

    rate = acceleration(case)

    def run(rtol):
        begun = time.process_time()
        done = solve_ivp(rate, (0, case.end), np.concatenate([case.q, case.v]), name, rtol=max(rtol, 3e-14), atol=rtol * 1e-2)
        return time.process_time() - begun, done.y[: len(case.q), -1]

    return {name: Method(False, run)}


def peers(text, stiff):
    """Rivals that are installed and take the case: from their names to their methods."""
    if "urdf" in tomllib.loads(text)["robot"] and "pinocchio" in MISSING:
        return {}
    case, found = read(text), {}
    if "mujoco" not in MISSING:
        found["MuJoCo"] = mujoco_methods(case)
    if "exudyn" not in MISSING:
        found["exudyn"] = exudyn_methods(case)
    if not {"pinocchio", "scipy"} & set(MISSING):
        found["SciPy + Pinocchio"] = scipy_methods(case, "Radau" if stiff else "DOP853")
    return {name: methods for name, methods in found.items() if methods}
