"""A script that uses every class, method and function, for the type checker."""

import concurrent.futures
import importlib
import tempfile
import warnings
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import springpot as sp
import springpot.mujoco
import springpot.pinocchio
from springpot._tables import Metrics, Rows

Array = NDArray[np.float64]

TEXT = """
robot.body = [{ name = "arm", joint = { name = "q1", kind = "revolute", axis = [0, 1, 0] }, mass = 1, com = [0.2, 0, 0] }]
robot.gripper = { body = "arm", point = [0.4, 0, 0] }
motion = { kind = "forward" }
time = { end = "1 s", output_step = "10 ms" }
event = [{ name = "turn", when = "v.q1" }]
metric = [{ name = "largest", of = "q.q1", kind = "max" }]
[[element]]
name = "strut"
from = { body = "world", point = [0, 0, -0.3] }
to = { body = "arm", point = [0.3, 0, 0] }
rest_length = "42 cm"
law = "magnetorheological"
parameters = { E_c = 40, mu_0 = "50 N*s^alpha/m", mu = 10, alpha = 0.4 }
inputs = { u = "1 V" }
"""


SMOOTH = TEXT.replace('event = [{ name = "turn", when = "v.q1" }]\n', "")

DESIGN = SMOOTH.replace("kind = \"max\"", "kind = \"rms\"") + """
[[parameter]]
name = "order"
path = "element.strut.alpha"
bounds = [0.2, 0.8]
[design]
minimise = "largest"
"""


def robots() -> None:
    model: sp.Model = sp.Model.from_scenario(TEXT, set={"robot.body.arm.mass": "1.5 kg"})
    mjcf: sp.Model = sp.Model.from_mjcf(
        Path(__file__).parents[3] / "testdata" / "mjcf" / "arm.xml", accept_inertia=False, package_path=[], gravity=None
    )
    assert mjcf.nv == 20
    urdf: sp.Model = sp.Model.from_urdf(Path(__file__).parents[3] / "testdata" / "multibody" / "ur5.urdf", gravity=[0, 0, -1.62])
    words: list[str] = [model.name, *model.joint_names, *model.joint_kinds, *model.q_names, *model.v_names, *urdf.warnings]
    frames: list[str] = [*model.body_names, *model.body_parents, *model.frame_names, model.gripper_body or "", *words]
    counts: tuple[int, int] = (model.nq, model.nv)
    facts: list[Array] = [model.gravity_vector, model.masses, model.inertias, model.damping, model.friction, model.armature]
    facts.append(model.body_numbers)
    limits: list[Array] = [model.lower_limits, model.upper_limits, model.velocity_limits, model.effort_limits]
    mass: float = model.mass
    q, v = model.normalise(model.neutral()), np.zeros((3, 1))
    tau: Array = model.rnea([0.1], [0.0], [0.0])
    model.nonlinear_effects(q, v, out=np.empty((3, 1)))
    a: Array = model.aba(q, v, v)
    square: list[Array] = [model.crba(q), model.mass_inverse(q), model.coriolis(q, v), model.christoffel(q)]
    by_q, by_v = model.rnea_derivatives(v, [0.0], v)
    model.aba_derivatives(v, [0.0], v, out=(by_q, by_v))
    slopes: list[Array] = [model.mass_derivative(q), model.joint_torque_regressor(q, v, v), *model.rnea_second_derivatives(q, v, v)]
    momenta: list[Array] = [model.centroidal_matrix(q), model.centroidal_matrix_rate(q, v)]
    force: Array = model.gravity(model.random(seed=1, count=3))
    points: list[Array] = [model.com(q), model.com_jacobian(q), model.integrate(q, v), model.difference(q, q)]
    energy: float = model.kinetic_energy(q, [1.0]) + model.potential_energy(q)
    rotation, place = model.frame_placement("arm", q)
    jacobian: Array = model.frame_jacobian("arm", q) + model.frame_jacobian_rate("arm", q, [1.0])
    start, end = ("world", [0, 0, -0.3]), ("arm", (0.3, 0, 0))
    length, gradient = model.pair_length(start, end, q)
    along: Array = sp.element_regressor(model, start, end, [0.0, 0.1, 0.2], v, rest_length=0.4, orders=[0.0, 0.5])
    print(frames, counts, facts, limits, mass, tau, a, square, force, points, energy, rotation, place, jacobian, length, gradient)
    print(slopes, momenta, along)


def simulations() -> None:
    def controller(t: float, q: Array, v: Array) -> Array:
        return -10 * q - v

    def voltage(t: float, q: Array, v: Array) -> float:
        return 1.0 if v[0] > 0 else 0.0

    simulation: sp.Simulation = sp.Simulation(
        TEXT, controller=controller, inputs={"strut.u": (voltage, "20 ms")}, sample="10 ms", set={"time.end": 0.5}
    )
    sp.Simulation(TEXT, inputs={"strut.u": "2 V"}, motions={"q1": lambda t: 0.1 * t}, motion_step=0.1)
    while simulation.t < 0.1 and simulation.step():
        pass
    moving: sp.Simulation = sp.Simulation(SMOOTH, sensitivity="element.strut.alpha")
    tangents: tuple[Array, Array, list[str]] = (moving.dq, moving.dv, moving.parameters)
    simulation.step_to("200 ms")
    snapshot: sp.Snapshot = simulation.interpolate(0.5 * (simulation.t_before + simulation.t))
    snapshot = simulation.snapshot()
    force: float = snapshot["strut.force"]
    unit: str = snapshot.units["strut.force"]
    known: dict[str, float] = {**dict(snapshot.items()), **dict(zip(snapshot.keys(), snapshot.values()))}
    nothing: float | None = snapshot.get("strut.nothing")
    vectors: list[Array] = [snapshot.q, snapshot.v, snapshot.a, simulation.q, simulation.v]
    state: sp.SimulationState = simulation.state()
    simulation.set_torque("q1", "2 N*m")
    simulation.set_torques([0.0])
    simulation.set_input("strut", "u", None)
    simulation.set_state(sp.SimulationState.from_bytes(state.to_bytes()))
    times: list[float] = [simulation.end, snapshot.t, state.t]
    words: list[str] = [*simulation.columns, *simulation.units, *simulation.element_names, simulation.model.name]
    steps: int = simulation.report["steps"]
    events: tuple[list[tuple[str, float]], str | None] = (simulation.passed, simulation.stopped_by)
    print(force, unit, known, nothing, vectors, times, words, steps, events)


def materials() -> None:
    law: sp.Law = sp.law("springpot", c="50 N*s^alpha/m", alpha=0.4)
    mount: sp.Law = sp.network("series(spring(k), springpot(c, a))", k=3.0, c=4.0, a=0.5)
    modulus: NDArray[np.complex128] = law.modulus([1.0, 2.0])
    relaxed: Array = mount.relaxation([0.1, 1.0])
    words: list[str] = [law.name, law.equation, law.source, law.derivative, *mount.leaves, *mount.inputs, *law.units]
    again: sp.Law = sp.Law(law.description)
    linear: bool = again.is_linear and law.parameters == again.parameters
    equations: list[str] = [row["equation"] for row in sp.laws()]
    found, deviation = sp.datasheet([("stiffness", "5 kN/m", 0.0)])
    fitted, spread, sigmas = sp.fit([1.0, 2.0, 3.0], law.modulus([1.0, 2.0, 3.0]), law="springpot")

    series: sp.Prony = sp.prony(sp.law("fractional-kelvin-voigt", k=3, c=4, alpha=0.5), (1e-3, "10 s"))
    bounds: tuple[float, float, float, int] = (series.equilibrium, series.error, series.rtol, len(series))
    terms: list[Array] = [series.moduli, series.times, series.relaxation([1.0])]
    answer: NDArray[np.complex128] = series.modulus(1.0)
    text: str = series.csv() + series.abaqus() + series.ansys("elastic")

    bank: sp.Bank = sp.Bank([law, {"law": "spring", "parameters": {"k": 3.0}}], nodes="radau", step="1 ms", horizon=10.0)
    bank.begin([0.0, 0.0])
    forces, by_stroke, by_rate = bank.evaluate(0.0, 0.1, np.zeros((2, 3)))
    bank.commit()
    bank.restart()
    bank.set_state(bank.state())
    energies: list[Array] = [bank.stored, bank.dissipated, bank.supplied, bank.nodes, bank.matrix_of_nodes]
    more: tuple[list[str], list[str], float, int] = (bank.names, bank.inputs, bank.t, bank.modes)
    print(modulus, relaxed, words, linear, equations, found, deviation, fitted, spread, sigmas, bounds, terms, answer, text)
    print(forces, by_stroke, by_rate, energies, more)


MJCF = """
<mujoco><worldbody><site name="a"/><body pos="1 0 0"><joint type="slide"/><geom size=".1"/><site name="b"/></body></worldbody></mujoco>
"""


def engines() -> None:
    law: sp.Law = sp.law("magnetorheological", E_c=40, mu_0=50, mu=10, alpha=0.4)
    if find_spec("mujoco"):
        mujoco: Any = importlib.import_module("mujoco")
        model = mujoco.MjModel.from_xml_string(MJCF)
        data = mujoco.MjData(model)
        strut: dict[str, Any] = {"from": "a", "to": "b", "rest_length": "start", "law": law, "inputs": {"u": "1 V"}}
        with springpot.mujoco.Elements(model, data, [strut], horizon="10 s") as elements:
            mujoco.mj_step(model, data)
            kept: springpot.mujoco.State = elements.state()
            elements.set_input(elements.names[0], "u", lambda t: 1.0 + t)
            elements.set_state(kept)
            geometry: list[Array] = [elements.rest_lengths, elements.lengths, elements.strokes, elements.rates]
            energies: list[Array] = [elements.forces, elements.stored, elements.dissipated, elements.supplied]
            row: dict[str, float] = elements["0"]
            facts: tuple[float, float | None, bool, int] = (elements.t, elements.begun_at, elements.enabled, len(elements))
            twin = mujoco.MjData(model)
            other: springpot.mujoco.Elements = elements.copy(twin)
            other.reset()
            other.disable()
            other.enable()
            print(geometry, energies, row, facts, other)
            other.disable()
    if find_spec("pinocchio"):
        pinocchio: Any = importlib.import_module("pinocchio")
        model = pinocchio.Model()
        still = pinocchio.SE3.Identity()
        joint = model.addJoint(0, pinocchio.JointModelPZ(), still, "q")
        model.addFrame(pinocchio.Frame("tip", joint, still, pinocchio.FrameType.OP_FRAME))
        end = {"frame": "tip", "point": [0.1, 0.0, 0.0]}
        ties = springpot.pinocchio.Elements(model, [{"from": "universe", "to": end, "rest_length": 0.1, "law": law, "inputs": {"u": 1.0}}])
        ties.begin([0.2])
        generalized, by_q, by_v = ties.evaluate(0.0, 0.01, [0.21], [1.0])
        ties.commit()
        ties.set_input("0", "u", 2.0)
        ties.set_state(ties.state())
        arrays: list[Array] = [generalized, by_q, by_v, ties.lengths, ties.rest_lengths, ties.forces]
        print(arrays, ties.names, ties.bank, len(ties))


def calculus() -> None:
    half: Array = sp.fractional.derivative([0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7], np.zeros(8), 0.5)
    values, errors = sp.fractional.derivative(np.linspace(0, 1, 20), np.zeros(20), 0.5, with_error=True)
    relaxed: float = sp.fractional.mittag_leffler(-1.0, 0.5)
    kelvin: float = sp.units.parse("25 degC", "K")
    degrees: Array = sp.units.convert(np.array([0.1, 0.2]), "rad", "deg")
    print(half, values, errors, relaxed, kelvin, degrees, sp.units.convert(kelvin, "K", "degC"), sp.__version__)


def runs(folder: Path) -> None:
    told: list[float] = []
    run: sp.Run = sp.run(TEXT, set={"element.strut.u": 2}, progress=told.append, jobs=1)
    force: Array = run["strut.force"]
    with concurrent.futures.ThreadPoolExecutor(2) as client:
        grid: sp.Run = sp.sweep(TEXT, sweep={"element.strut.alpha": [0.3, 0.6]}, client=client, out=folder / "grid", chunk=1)
    case: sp.Case = grid.case(1)
    column: Array = case["strut.force"]
    called: tuple[int, dict[str, float | str], dict[str, str]] = (case.index, case.parameters, case.units)
    failed: sp.RunError | None = case.error
    sizes: tuple[int, list[tuple[float, float, float]], bool] = (case.rows, case.statistics, grid == run)
    indices: list[int] = [one.index for one in grid]
    said: tuple[dict[str, Any], list[str]] = (case.report, case.limits)
    words: list[str] = [grid.title or "", *grid.parameters, *grid.columns, *grid.units, *grid.meanings]
    failures: dict[int, sp.RunError] = grid.failures
    first: sp.Case = grid.cases[0]
    metrics: Metrics = grid.metrics
    events: Rows = run.events
    summary: Sequence[dict[str, Any]] = grid.summary
    row: dict[str, Any] = metrics[0]
    some: Sequence[dict[str, Any]] = events[:2]
    largest: float = run.metrics["largest"]
    tangents: sp.Run = sp.run(SMOOTH, sensitivity=["element.strut.alpha", "element.strut.mu"])
    slopes: list[Array] = [tangents.sensitivity("q.q1"), tangents.sensitivity("q.q1", tangents.parameters[0])]
    by: dict[str, float] = tangents.gradient("largest")
    of_case: Array = tangents.case(0).sensitivity("strut.force")
    lost: list[tuple[str, float, str]] = tangents.case(0).lost
    value, by = sp.gradient(SMOOTH, "largest", "element.strut.alpha", set={"time.end": 0.1})
    by = tangents.case(0).gradient("largest")
    found: sp.Design = sp.design(DESIGN, set={"time.end": 0.1}, starts=1, jobs=1)
    order: sp.DesignedParameter = found.parameters["order"]
    facts: tuple[str, str, float, str, float, str | None, float] = (
        order.name, order.path, order.value, order.unit, order.before, order.at_bound, order.gradient
    )
    rest: list[Any] = [found.status, found.objective, found.constraints, found.starts, found.runs, found.steps["objective"]]
    designed: sp.Run = sp.run(found.scenario)
    designed = found.run(jobs=1)
    table: dict[str, NDArray[Any]] = grid.table()
    files: list[str] = run.save(folder / "run", format="npz", figures=False)
    back: sp.Run = sp.read(folder / "run")
    again: sp.Run = sp.sweep(TEXT, sweep={"element.strut.alpha": [0.3, 0.6]}, columns=["t", "strut.*"])
    none: sp.Run = sp.sweep(TEXT, rows=False)
    plane: sp.Run = sp.run(TEXT, sweep={"element.strut.alpha": [0.3, 0.6], "element.strut.mu": [5, 10]})
    cells: sp.Figure = plane.map("max(strut.force)", "alpha", "mu", unit="kN", title="Peaks", y_scale="log", size=("90 mm", 0.06))
    print(cells, plane.map("metric(largest)", x="element.strut.mu", y="alpha", where={}))
    found_cases: list[sp.Case] = [grid.case(alpha=0.6), grid.case({"element.strut.alpha": 0.3}), grid.case(name=grid.case(0).name)]
    asked: dict[str, Any] = back.scenario
    print(back == run, again.columns, len(none), found_cases, asked["text"])
    if find_spec("xarray"):
        print(grid.to_xarray().sizes)
    page: Path = run.view(folder / "view.html", cases=[0], open=False)
    report: Path = run.report(folder / "report.html", other=run, open=False)
    figure: sp.Figure = run.figure("strut.force", "strut.stroke", units={"strut.stroke": "mm"}, size=("90 mm", "60 mm"), legend=False)
    print(figure.save(folder / "loop.pdf"), len(figure.svg), len(figure.png), figure.remarks, list(run.figures()))
    notes: list[str] = run.export(folder / "run.glb", case=0)
    print(page, report, notes)
    print(sizes, indices, told, force, column, called, failed, said, words, failures, first, summary, row, some, largest, table, files)
    if find_spec("pandas"):
        print(run.to_pandas().shape, events.to_pandas().shape)
    if find_spec("polars"):
        print(run.to_polars().shape)
    if find_spec("matplotlib"):
        import matplotlib

        matplotlib.use("Agg")
        print(grid.plot(["strut.force", "strut.stroke"], cases=[0]).get_title())


def master_curves() -> None:
    frequency = np.tile(np.geomspace(1.0, 100.0, 9), 3)
    temperature = np.repeat([283.15, 293.15, 303.15], 9)
    grown = (frequency * 10.0 ** ((293.15 - temperature) / 20.0)) ** 0.4
    curve: sp.Master = sp.master(frequency, 1e6 * (1.0 + grown), 4e5 * grown, temperature, "20 degC")
    print(curve.shift, curve.log10_a_T, curve.wlf, curve.arrhenius["energy"])


def fits(scratch: Path) -> None:
    t = np.geomspace(0.01, 100.0, 9)
    records = {"tap": {"t": t, "G": 50.0 * t**-0.5 / np.sqrt(np.pi)}}
    scenario = {
        "element": [{"name": "pad", "law": "springpot", "parameters": {"c": 10, "alpha": 0.4}}],
        "parameter": [{"name": "c", "path": "element.pad.c"}, {"name": "alpha", "path": "element.pad.alpha"}],
        "data": [{"name": "tap", "kind": "relaxation", "element": "pad", "csv": "tap.csv", "columns": {"t": "t", "relaxation": "G"}}],
    }
    found: sp.Fit = sp.fit(scenario, records)
    alpha: sp.Parameter = found.parameters["alpha"]
    print(found.status, alpha.value, alpha.sd, alpha.interval, found.covariance, found.correlation, found.undetermined)
    print(found.residuals["tap"]["relaxation"], found.scenario, found)
    found.save(scratch / "fit")
    problem: sp.Problem = sp.problem(scenario, records)
    print(problem.names, problem.units, problem.bounds, problem.residuals(problem.start), problem.jacobian(problem.start))


def small_motions() -> None:
    scenario = {"robot": {"body": [{"name": "b", "mass": 2, "joint": {"name": "x", "kind": "prismatic", "axis": [1, 0, 0]}}]},
                "element": [{"name": "e", "joint": "x", "law": "kelvin-voigt", "parameters": {"k": 50, "c": 4}}],
                "motion": {"kind": "forward"}, "time": {"end": 1, "output_step": 0.5}}
    model: sp.LinearModel = sp.linearise(scenario, ["tau.x"], ["q.x"], band=("0.1 Hz", 10), tolerance=1e-3)
    print(model.A, model.B, model.C, model.D, model.inputs, model.outputs, model.states, model.units, model.band, model.error, model.about)
    answers: NDArray[np.complex128] = sp.frequency_response(scenario, "tau.x", "q.x", [0.1, 1.0], at=0, open=True)
    print(answers, sp.modes(scenario, equilibrium=True)["eigenvalues"], model.to_scipy())
    try:
        print(model.to_control())
    except ImportError as error:
        print(error)


def tools(scratch: Path) -> None:
    findings: list[sp.Finding] = sp.check(TEXT, set={"element.strut.u": 2})
    for finding in findings:
        where: tuple[str | None, int | None, int | None] = (finding.path, finding.line, finding.column)
        print(where, finding.message, finding.help)
    modulus: sp.Modulus = sp.modulus(TEXT, "strut", amplitude=["1 mm", 0.002], frequencies=[1.0, "10 Hz"])
    arrays: list[Array] = [modulus.frequency, modulus.storage, modulus.loss, modulus.tan_delta, modulus.cycle]
    print(arrays, modulus.element, modulus.unit, modulus.amplitude, modulus.complex)
    try:
        file: Path = sp.fmu(TEXT, scratch / "arm.fmu", set={"element.strut.alpha": 3})
        print(file)
    except sp.ScenarioError as error:
        print(error.line)


def mistakes() -> None:
    warnings.simplefilter("ignore", category=sp.SpringpotWarning)
    try:
        sp.Simulation("a = 1")
    except sp.ScenarioError as error:
        place: tuple[str | None, int | None, int | None] = (error.path, error.line, error.column)
        print(place, error.help, error.refusals)
    try:
        sp.Model.from_urdf("nothing.urdf")
    except sp.ModelError as error:
        print(error)
    except sp.RunError as error:
        print(error.t)
    except sp.SpringpotError:
        raise


robots()
simulations()
materials()
master_curves()
engines()
calculus()
small_motions()
with tempfile.TemporaryDirectory() as scratch:
    runs(Path(scratch))
    fits(Path(scratch))
    tools(Path(scratch))
mistakes()
