"""What objects show of themselves, when they are equal, and how they go to other processes and come back."""

from __future__ import annotations

import copy
import pickle
import random
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ARM, ROOT
from test_run import GRID, SLIDE

import springpot as sp

UR5 = ROOT / "testdata/multibody/ur5.urdf"
TABLE = sp.network("parallel(table(f), dashpot(eta))", parameters={"f": ([-1.0, 0.0, 1.0], [-2.0, 0.0, 3.0])}, eta=3.0)


@pytest.fixture(scope="module")
def grid() -> sp.Run:
    return sp.run(SLIDE, sweep=GRID)


@pytest.fixture(scope="module")
def arm() -> sp.Simulation:
    simulation = sp.Simulation(ARM, controller=lambda t, q, v: -10 * q, sample=0.01)
    simulation.step_to(0.1)
    return simulation


def series() -> sp.Prony:
    return sp.prony(sp.law("springpot", c=50.0, alpha=0.5), (1e-2, 1.0))


def test_each_shows_itself_in_one_line(grid: sp.Run) -> None:
    model = sp.Model.from_urdf(UR5)
    one = sp.run(SLIDE)
    shown: list[tuple[Any, str]] = [
        (grid, r"<Run of 6 cases: \d+ columns>"),
        (sp.run('title = "Slide"\n' + SLIDE), r"<Run 'Slide' of 1 case: \d+ columns>"),
        (grid.case(2), r"<Case 2 .*u = 1, .*alpha = 0.3: 101 rows, \d+ columns>"),
        (one.figure("pad.force"), r"<Figure: \d+ x \d+ pt>"),
        (one.figures()["force"], r"<Figure: \d+ x \d+ pt>"),
        (grid.metrics, r"<Metrics of 6 cases: peak>"),
        (grid.summary, r"<Rows: \d+ rows of element.pad.u, .*, column, unit, min, max, rms>"),
        (TABLE, r'Law\("parallel\(table\(f\), dashpot\(eta\)\)", eta=3, f=<3 points>, derivative="caputo"\)'),
        (sp.law("spring", k=2.0), r'Law\("spring", k=2, derivative="caputo"\)'),
        (series(), r"Prony\(\d+ branches, .*\)"),
        (model, r'Model\("ur5", nq=6, nv=6, joints=6\)'),
    ]
    for found, pattern in shown:
        assert re.fullmatch(pattern, repr(found)), repr(found)


def test_notebooks_have_tables(grid: sp.Run) -> None:
    model = sp.Model.from_urdf(UR5)
    failing = sp.run(SLIDE, sweep={"element.pad.u": [1, "1-4*t"]})
    tables: list[tuple[Any, list[str]]] = [
        (grid, ["6 cases", "element.pad.alpha", "<td>0.6</td>"]),
        (failing, ["1 failed", "1-4*t", "mu_0 + u·mu ≥ 0 is broken"]),
        (sp.run('title = "a < b & c"\n' + SLIDE), ["<caption>a &lt; b &amp; c: Case 0", "pad.force", "<td>N</td>"]),
        (grid.case(1), ["Case 1: element.pad.u = 0, element.pad.alpha = 0.6, 101 rows", "pad.force"]),
        (grid.metrics, ["<th>metric</th>", "peak"]),
        (grid.summary, ["<th>rms</th>", "… and "]),
        (TABLE, ["3 points", "<td>eta</td><td>3</td><td>N*s/m</td>"]),
        (model, ["ur5: 6 joints", "upper_arm_link"]),
        (series(), ["branches", "<th>time, s</th>"]),
    ]
    for found, words in tables:
        html = found._repr_html_()
        assert [word for word in words if word not in html] == [], html
        assert html.count("<tr>") < 25 and html.startswith("<table>") and html.endswith("</table>")


def test_runs_and_cases_are_equal_where_their_numbers_are(grid: sp.Run) -> None:
    again = pickle.loads(pickle.dumps(grid))
    assert grid == again and grid.case(3) == again.case(3) and hash(grid) == hash(again)
    assert grid.case(3) != grid.case(2) and grid != sp.run(SLIDE) and grid != 3 and grid.case(0) != {}
    other = sp.run(SLIDE, set={"robot.body.mass.mass": 2.0000001})
    assert other != sp.run(SLIDE) and other.case(0) != sp.run(SLIDE).case(0)
    # Empty cells are NaN, and so are the same ones.
    failing = sp.run(SLIDE, sweep={"element.pad.u": [1, "1-4*t"]})
    assert failing == sp.run(SLIDE, sweep={"element.pad.u": [1, "1-4*t"]})
    assert grid.metrics == again.metrics and grid.summary == again.summary and grid.metrics != grid.summary


def test_laws_are_equal_where_they_are_one_law() -> None:
    pot = sp.law("springpot", c="0.5 N*s^alpha/cm", alpha=0.3)
    for law in (pot, TABLE, sp.law("prony", k_e=1.0, k=[2.0, 3.0], tau=[0.1, 1.0])):
        again = pickle.loads(pickle.dumps(law))
        assert law == again and hash(law) == hash(again) and law == copy.deepcopy(law)
        assert law == (sp.network(law.name, parameters=law.parameters) if law is TABLE else sp.law(law.name, **law.parameters))
    assert pot == sp.law("springpot", c=50, alpha=0.3) == sp.Law({"name": "strut", **pot.description})
    assert pot != sp.law("springpot", c=50, alpha=0.31) and pot != sp.law("springpot", c=50, alpha=0.3, derivative="riemann-liouville")
    assert pot != "springpot" and pot != sp.network("springpot(c, alpha)", c=50, alpha=0.3)
    assert TABLE.parameters["f"] == ([-1.0, 0.0, 1.0], [-2.0, 0.0, 3.0]) and TABLE.units == {"eta": "N*s/m", "f": "m, N"}
    assert TABLE != sp.network(TABLE.name, parameters={"f": ([-1.0, 0.0, 1.0], [-2.0, 0.0, 3.5])}, eta=3.0)


def test_a_run_goes_through_its_cases(grid: sp.Run) -> None:
    assert [case.index for case in grid] == list(range(6)) == [case.index for case in list(grid)]
    assert "pad.force" in grid and "nothing" not in grid
    assert grid.case(-1).index == 5
    with pytest.raises(IndexError, match="no case 9: the run has 6 cases, 0 to 5"):
        grid.case(9)
    with pytest.raises(IndexError, match="no case 1: the run has 1 case, 0"):
        sp.run(SLIDE).case(1)
    with pytest.raises(TypeError, match=r"a case is run.case\(k\)"):
        grid[0]  # type: ignore[index]


def test_names_are_completed_and_suggested(grid: sp.Run, arm: sp.Simulation) -> None:
    offered: list[tuple[Any, str]] = [(grid, "pad.force"), (grid.case(0), "pad.force"), (grid.metrics, "peak"), (grid.summary, "rms")]
    for holder, name in [*offered, (arm.snapshot(), "strut.force")]:
        assert name in holder._ipython_key_completions_() and holder is not None
    for wrong, match in [("pead", "no metric 'pead'; did you mean 'peak'"), ("zzz", "no metric 'zzz'; there is peak")]:
        with pytest.raises(KeyError, match=match):
            grid.metrics[wrong]
    with pytest.raises(KeyError, match="no column 'rmz'; did you mean 'rms'"):
        grid.summary["rmz"]


def test_snapshots_and_series_are_copied(arm: sp.Simulation) -> None:
    now = arm.snapshot()
    for again in (pickle.loads(pickle.dumps(now)), copy.deepcopy(now)):
        assert dict(again) == dict(now) and again.units == now.units and again.t == now.t and list(again) == list(now)
        assert all(np.array_equal(getattr(again, name), getattr(now, name)) for name in "qva")
    of = series()
    again = pickle.loads(pickle.dumps(of))
    assert again == of == copy.copy(of) and hash(again) == hash(of) and again.csv() == of.csv() and again.abaqus is not None
    assert of != sp.prony(sp.law("springpot", c=50.0, alpha=0.6), (1e-2, 1.0)) and of != 1


def test_what_is_not_copied_says_what_is(arm: sp.Simulation) -> None:
    bank = sp.Bank([sp.law("spring", k=1.0)])
    for attempt in (pickle.dumps, copy.copy, copy.deepcopy):
        with pytest.raises(TypeError, match=r"keep its state\(\)"):
            attempt(bank)
    with pytest.raises(TypeError, match=r"must be picklable, functions of a module and no lambdas: .*; its state\(\) is picklable"):
        pickle.dumps(arm)


def hold(t: float, q: Any, v: Any) -> Any:
    return -10 * q - v


def volts(t: float, q: Any, v: Any) -> float:
    return 1.0 + float(q[0])


def test_a_simulation_goes_on_in_a_copy_and_in_another_process() -> None:
    first = sp.Simulation(ARM, set={"element.strut.alpha": 0.5}, controller=hold, inputs={"strut.u": (volts, "20 ms")}, sample=0.01)
    first.step_to(0.123)
    first.set_torque("q1", 0.5)
    copies = [first.copy(), copy.copy(first), copy.deepcopy(first), pickle.loads(pickle.dumps(first))]
    copies.append(pickle.loads(pickle.dumps(copies[-1])))
    assert all(other is not first and (other.t, other.q, other.model.nq) == (first.t, first.q, 1) for other in copies)
    copies[0].step_to(0.3)
    assert first.t == 0.123
    first.step_to(0.3)
    for other in copies:
        other.step_to(0.3)
        assert dict(other.snapshot()) == dict(first.snapshot())
    moved = sp.Simulation(ARM, motions={"q1": (np.linspace(0, 2, 9), np.linspace(0, 1, 9) ** 2)})
    moved.step_to(0.5)
    assert pickle.loads(pickle.dumps(moved)).q == moved.q == moved.copy().q
    differentiated = sp.Simulation(ARM, sensitivity="element.strut.alpha")
    differentiated.step_to(0.5)
    assert np.array_equal(pickle.loads(pickle.dumps(differentiated)).dq, differentiated.dq)


def pickled(grid: sp.Run, arm: sp.Simulation) -> dict[str, tuple[Any, bytes]]:
    """Bytes of each, and what makes it again."""
    model = sp.Model.from_urdf(UR5)
    objects = [arm.state(), model, arm.model, series(), arm.snapshot(), grid._study, grid.case(1)._case]
    made = [one.__reduce__() for one in objects]
    return {f"{k} {type(one).__name__}": (maker, data[0]) for k, (one, (maker, data)) in enumerate(zip(objects, made))}


def test_damaged_pickles_are_refused(grid: sp.Run, arm: sp.Simulation) -> None:
    chance = random.Random(28)
    for name, (make, whole) in pickled(grid, arm).items():
        make(whole)
        places = [*range(min(80, len(whole))), *(chance.randrange(len(whole)) for _ in range(120))]
        for at in places:
            torn = bytearray(whole)
            torn[at] ^= 1 << chance.randrange(8)
            with pytest.raises(ValueError):
                make(bytes(torn))
        for length in (0, 1, 20, len(whole) // 2, len(whole) - 1):
            with pytest.raises(ValueError):
                make(whole[:length])
        with pytest.raises(ValueError):
            make(whole + b"\0")
        for other, (_, data) in pickled(grid, arm).items():
            if other.split()[1] != name.split()[1]:
                with pytest.raises(ValueError):
                    make(data)


def test_warnings_have_a_class(tmp_path: Path) -> None:
    assert issubclass(sp.SpringpotWarning, UserWarning)
    robot = sp.Model.from_urdf(UR5)
    still = {"kind": "prescribed", "joints": {name: "0.1*t" for name in robot.joint_names}}
    scenario = {"robot": {"urdf": UR5}, "motion": still, "time": {"end": 0.1, "output_step": 0.05}}
    for words in ({}, {"out": tmp_path / "out"}):
        with pytest.warns(sp.SpringpotWarning, match="mesh"):
            sp.run(scenario, **words)


def test_missing_files_are_found_missing() -> None:
    calls: list[tuple[Any, type[Exception]]] = [
        (lambda: sp.run("nope.toml"), sp.ScenarioError),
        (lambda: sp.Model.from_scenario("nope.toml"), sp.ScenarioError),
        (lambda: sp.Simulation("nope.toml"), sp.ScenarioError),
        (lambda: sp.Model.from_urdf("nope.urdf"), sp.ModelError),
    ]
    for call, error in calls:
        with pytest.raises(FileNotFoundError) as missing:
            call()
        found = missing.value
        assert isinstance(found, error) and "nope." in str(found) and str(found.filename).startswith("nope.")
        again = pickle.loads(pickle.dumps(found))
        assert (str(again), again.filename, again.errno, type(again)) == (str(found), found.filename, 2, type(found))
    with pytest.raises(sp.ScenarioError) as folder:
        sp.run(".")
    assert not isinstance(folder.value, FileNotFoundError) and isinstance(folder.value, ValueError)
