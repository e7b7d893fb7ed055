"""FMUs of `springpot fmu` in FMPy: valid, the numbers of `springpot run`, rollback, and what is refused.

Run by check.sh, which says where the command is: SPRINGPOT=target/debug/springpot pytest tests/fmu.py
"""

import csv
import ctypes
import os
import pathlib
import subprocess
import tempfile

import fmpy
import fmpy.fmi2
import fmpy.validation
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

COMMAND = os.environ["SPRINGPOT"]
SCENARIOS = pathlib.Path(__file__).parents[3] / "scenarios"
ERROR = 3


def unswept(name):
    """A scenario that comes with Springpot, without its sweeps and figures."""
    text = (SCENARIOS / f"{name}.toml").read_text()
    kept = text.split("[[sweep]]")[0]
    assert "[time]" in kept
    return kept


def springpot(*arguments):
    done = subprocess.run([COMMAND, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def packed(folder, name, text, *options):
    scenario = folder / f"{name}.toml"
    scenario.write_text(text)
    springpot("fmu", scenario, "--out", folder / f"{name}.fmu", *options)
    return str(folder / f"{name}.fmu")


def rows_of(folder, name, *options):
    springpot("run", folder / f"{name}.toml", "--out", folder / "results", "--no-figures", "--quiet", *options)
    with open(folder / "results" / "results.csv", newline="") as file:
        table = list(csv.DictReader(file))
    return {column: np.array([float(row[column] or "nan") for row in table]) for column in table[0]}


@pytest.fixture(scope="module", autouse=True)
def unpacked():
    """All that is unpacked goes into one folder, which does not stay: each has a library of 45 MB in it."""
    with tempfile.TemporaryDirectory() as folder, pytest.MonkeyPatch.context() as patch:
        patch.setattr(tempfile, "tempdir", folder)
        yield


@pytest.fixture(scope="module")
def fall(tmp_path_factory):
    """The arm that falls on a thermoviscoelastic strut."""
    folder = tmp_path_factory.mktemp("fall")
    return folder, packed(folder, "fall", unswept("falling_thermoviscoelastic"))


@pytest.fixture(scope="module")
def damped(tmp_path_factory):
    """The arm that falls on a magnetorheological damper."""
    folder = tmp_path_factory.mktemp("damped")
    return folder, packed(folder, "damped", unswept("falling_magnetorheological"))


class Instance:
    """An instance at t = 0."""

    def __init__(self, fmu, name="one", **start):
        self.description = fmpy.read_model_description(fmu)
        self.folder = fmpy.extract(fmu)
        self.references = {v.name: v.valueReference for v in self.description.modelVariables}
        identifier = self.description.coSimulation.modelIdentifier
        self.messages = []
        self.fmu = fmpy.fmi2.FMU2Slave(
            guid=self.description.guid, unzipDirectory=self.folder, modelIdentifier=identifier, instanceName=name
        )
        # Kept: the FMU calls it until it is freed.
        self.logger = fmpy.fmi2.fmi2CallbackLoggerTYPE(lambda *told: self.messages.append(told[-1].decode()))
        callbacks = fmpy.fmi2.fmi2CallbackFunctions()
        callbacks.logger = self.logger
        self.fmu.instantiate(callbacks=callbacks)
        self.start(**start)

    def start(self, **start):
        self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()
        for name, value in start.items():
            self.set(name.replace("__", "."), value)
        self.fmu.exitInitializationMode()

    def set(self, name, value):
        self.fmu.setReal([self.references[name]], [value])

    def get(self, *names):
        return self.fmu.getReal([self.references[name] for name in names])

    def all(self):
        return np.array(self.fmu.getReal(sorted(self.references.values())))

    def steps(self, times):
        rows = []
        for before, after in zip(times, times[1:]):
            self.fmu.doStep(currentCommunicationPoint=before, communicationStepSize=after - before)
            rows.append(self.all())
        return np.array(rows)


def compared(fmu_rows, rows, columns, rtol):
    for column in columns:
        name = f"{column}.total" if column.startswith("tau.") else column
        scale = np.nanmax(np.abs(rows[column]))
        error = np.nanmax(np.abs(fmu_rows[name] - rows[column]))
        assert error <= rtol * scale, f"{column}: {error} of {scale}"


@pytest.mark.parametrize("which", ["fall", "damped"])
def test_fmpy_finds_no_problems(which, request):
    _, fmu = request.getfixturevalue(which)
    assert fmpy.validation.validate_fmu(fmu) == []
    assert "linux64" in fmpy.supported_platforms(fmu) or os.name != "posix"


def test_numbers_are_those_of_run(fall):
    folder, fmu = fall
    rows = rows_of(folder, "fall")
    columns = [column for column in rows if column not in ("t", "strut.T", "energy.residual")]
    names = [f"{column}.total" if column.startswith("tau.") else column for column in columns]
    result = fmpy.simulate_fmu(fmu, output=[*names, "energy.residual"])
    assert np.array_equal(result["time"].round(12), rows["t"])
    # Both end steps elsewhere: they agree to the tolerance.
    compared(result, rows, columns, 2e-7)
    assert np.abs(result["energy.residual"]).max() < 1e-7 * rows["energy.kinetic"].max()


def test_an_input_is_driven_from_outside(damped):
    folder, fmu = damped
    signal = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 3.0), (4.0, 3.0)], dtype=[("time", float), ("damper.u", float)])
    result = fmpy.simulate_fmu(fmu, input=signal, output=["q.q2", "damper.force", "damper.input"])
    # In an expression of the scenario the same voltage is switched on at the same time.
    rows = rows_of(folder, "damped", "--set", "element.damper.u=3*step(t - 1)")
    switched = rows["t"] != 1.0
    inside = {name: result[name][switched] for name in result.dtype.names}
    compared(inside, {name: rows[name][switched] for name in rows}, ["q.q2", "damper.force", "damper.input"], 2e-7)


def test_a_parameter_is_that_of_set(fall):
    folder, fmu = fall
    start = {"element.strut.alpha": 0.3, "motion.start.q.q2": 0.2, "strut.T": 310.0}
    result = fmpy.simulate_fmu(fmu, start_values=start, output=["q.q2", "strut.force"])
    options = ["element.strut.alpha=0.3", "motion.start.q.q2=0.2", "element.strut.T=310"]
    rows = rows_of(folder, "fall", *[word for option in options for word in ("--set", option)])
    compared(result, rows, ["q.q2", "strut.force"], 2e-7)


def test_steps_of_communication_have_any_size(fall):
    folder, fmu = fall
    rows = rows_of(folder, "fall")
    random = np.random.default_rng(7)
    times = np.unique(np.concatenate([[0.0], random.uniform(0.0, 5.0, 200), rows["t"][::50]]))
    instance = Instance(fmu)
    steps = instance.steps(times)
    on_rows = np.isin(times[1:], rows["t"][::50])
    for column in ["q.q2", "v.q3", "strut.force", "strut.dissipated"]:
        seen = steps[on_rows, instance.references[column]]
        scale = np.nanmax(np.abs(rows[column]))
        assert np.abs(seen - rows[column][50::50]).max() < 2e-7 * scale, column


def test_rollback_serialization_and_reset_give_the_same_bits(damped):
    _, fmu = damped
    times = np.arange(41) / 20
    one = Instance(fmu)
    whole = one.steps(times)
    one.fmu.reset()
    one.start()
    assert np.array_equal(one.steps(times[:21]), whole[:20])
    state = one.fmu.getFMUState()
    there = one.all()
    after = one.steps(times[20:31])
    one.set("damper.u", 7.0)
    one.steps(times[30:])
    for _ in range(2):
        one.fmu.setFMUState(state)
        assert np.array_equal(one.all(), there)
        assert np.array_equal(one.steps(times[20:31]), after)
    data = one.fmu.serializeFMUState(state)
    other = Instance(fmu, "other", element__damper__alpha=0.3)
    other.steps(times[:5])
    other.fmu.setFMUState(other.fmu.deserializeFMUState(data))
    assert np.array_equal(other.all(), there)
    assert np.array_equal(other.steps(times[20:31]), after)
    one.fmu.freeFMUState(state)
    with pytest.raises(FMICallException):
        one.fmu.setFMUState(state)


def test_two_instances_take_turns(damped):
    _, fmu = damped
    times = np.arange(21) / 10
    alone = [Instance(fmu).steps(times), Instance(fmu, damper__u=0.0).steps(times)]
    pair = [Instance(fmu, "a"), Instance(fmu, "b", damper__u=0.0)]
    together = [[], []]
    for step in zip(times, times[1:]):
        for instance, rows in zip(pair, together):
            rows.extend(instance.steps(step))
    assert np.array_equal(together[0], alone[0]) and np.array_equal(together[1], alone[1])
    assert not np.array_equal(alone[0], alone[1])


def refused(instance, call, words):
    with pytest.raises(FMICallException) as told:
        call()
    assert told.value.status == ERROR
    assert words in instance.messages[-1], instance.messages[-1]


def test_bad_input_is_an_error(damped):
    _, fmu = damped
    one = Instance(fmu)
    step = lambda t, h: lambda: one.fmu.doStep(currentCommunicationPoint=t, communicationStepSize=h)
    refused(one, lambda: one.set("damper.u", float("nan")), "cannot be set to NaN")
    refused(one, lambda: one.set("damper.u", -100.0), "mu_0")
    refused(one, lambda: one.set("q.q1", 1.0), "is no input")
    refused(one, lambda: one.fmu.getReal([9999]), "there is no real variable 9999")
    refused(one, step(0.0, 0.0), "a communication step of 0 s")
    refused(one, step(0.0, -0.1), "a communication step of -0.1 s")
    refused(one, step(1.0, 0.1), "the instance is at 0 s")
    one.steps([0.0, 0.1])
    one.fmu.terminate()
    assert np.isfinite(one.get("q.q1")).all()
    refused(one, lambda: one.set("damper.u", 1.0), "the instance is terminated")
    refused(one, step(0.1, 0.1), "the instance is terminated")
    # What was freed is refused, not followed.
    one.fmu.fmi2FreeInstance(one.fmu.component)
    with pytest.raises(FMICallException):
        one.get("q.q1")


def test_files_go_with_the_scenario(tmp_path):
    (tmp_path / "data").mkdir()
    lines = ["t,u"] + [f"{k / 10},{(k // 5) % 2}" for k in range(41)]
    (tmp_path / "data" / "u.csv").write_text("\n".join(lines))
    text = unswept("falling_magnetorheological").replace(
        'inputs = { u = "1 V" }', 'inputs = { u = { csv = "data/u.csv", column = "u", unit = "V" } }'
    )
    assert "data/u.csv" in text
    fmu = packed(tmp_path, "table", text, "--set", "time.end=2 s")
    rows = rows_of(tmp_path, "table", "--set", "time.end=2 s")
    (tmp_path / "data" / "u.csv").unlink()
    result = fmpy.simulate_fmu(fmu, output=["q.q2", "damper.force", "damper.u"])
    compared(result, rows, ["q.q2", "damper.force"], 2e-7)
    assert not (b"data/u.csv" in pathlib.Path(fmpy.extract(fmu), "resources", "scenario.toml").read_bytes())


def test_the_same_scenario_makes_the_same_file(tmp_path):
    text = unswept("falling_thermoviscoelastic")
    one, other = packed(tmp_path, "one", text), packed(tmp_path, "one", text)
    assert one == other
    first = pathlib.Path(one).read_bytes()
    packed(tmp_path, "one", text)
    assert pathlib.Path(one).read_bytes() == first


def test_a_library_with_a_law_of_its_own_knows_it_when_it_is_loaded():
    library = next(pathlib.Path(COMMAND).parent.glob("examples/*own_laws.[sd]*"), None)
    if library is None:
        pytest.skip("cargo build -p springpot-capi --example own_laws")
    element = b'{ "law": "twin-dashpot", "parameters": { "c_left": 3, "c_right": 4 } }'
    bank = ctypes.c_void_p()
    own = ctypes.CDLL(str(library))
    assert own.springpot_bank_new(element, 1, 0, ctypes.byref(bank)) == 0
    own.springpot_bank_free(bank)
    assert own.fmi2GetVersion is not None
