"""Results that come back from a folder, cases by what was swept, and data sets of xarray."""

import json
import pickle
import shutil
import subprocess
import sys

import numpy as np
import pytest

import springpot as sp
from conftest import ROOT
from test_run import GRID, SLIDE, command, files

NAMED = SLIDE + """
[[sweep]]
parameter = "element.pad.u"
values = [0, 1, "1-4*t"]
names = ["off", "on", "failing"]
[[sweep]]
parameter = ["element.pad.alpha", "robot.body.mass.mass"]
values = [[0.3, 2], [0.6, "3 kg"]]
[sensitivity]
of = ["q.x"]
[[parameter]]
path = "element.pad.mu_0"
"""


@pytest.fixture(scope="module")
def named(tmp_path_factory):
    """A run of everything: names, paths that move together, a failing value, events, metrics, derivatives."""
    folder = tmp_path_factory.mktemp("named") / "run"
    return sp.run(NAMED, out=folder), folder


def same(read, run):
    """Whether all that can be asked of two runs is one."""
    assert read == run and read.metrics == run.metrics and read.summary == run.summary and read.events == run.events
    for one, other in zip(read, run):
        assert (one.name, one.parameters, one.limits, one.lost) == (other.name, other.parameters, other.limits, other.lost)
        assert [one.report[key] == other.report[key] for key in one.report if key != "wall_time"].count(False) == 0
        assert str(one.error) == str(other.error) and (one.error is None or one.error.t == other.error.t)
    for what in ("title", "columns", "units", "meanings", "parameters", "scenario"):
        assert getattr(read, what) == getattr(run, what), what
    assert [read.table()[name].tobytes() for name in read.columns] == [run.table()[name].tobytes() for name in run.columns]


@pytest.mark.parametrize("format", ["csv", "parquet", "npz"])
def test_what_is_read_is_the_run(named, tmp_path, format):
    run, _ = named
    run.save(tmp_path / "run", format=format)
    read = sp.read(tmp_path / "run")
    same(read, run)
    assert len(read.failures) == 2 and "mu_0 + u·mu ≥ 0" in str(read.failures[4]) and read.case("failing, element.pad.alpha = 0.3, robot.body.mass.mass = 2")
    for case, other in zip(read, run):
        assert case.gradient("peak") == other.gradient("peak") or np.isnan(list(case.gradient("peak").values())).all()
    # It goes to other processes, makes figures and pages, and is copied.
    same(pickle.loads(pickle.dumps(read)), run)
    over = ("max(pad.force)", "element.pad.alpha")
    assert read.figure(*over, where={"element.pad.u": "on"}) == run.figure(*over, where={"element.pad.u": "on"})
    assert read.figures() == run.figures()
    assert read.report(tmp_path / "report.html").stat().st_size > 10_000
    assert read.save(tmp_path / "copy") and files(tmp_path / "copy") == files(tmp_path / "run")
    same(sp.read(tmp_path / "copy"), run)
    with pytest.raises(sp.SpringpotError, match="is not empty"):
        read.save(tmp_path / "copy")
    with pytest.raises(ValueError, match="copied as they are"):
        read.save(tmp_path / "other", format="npz" if format != "npz" else "csv")


def test_what_the_command_wrote_is_read(tmp_path):
    scenario = ROOT / "scenarios/point_to_point.toml"
    command("run", scenario, "--out", tmp_path / "run", "--quiet", "--format", "parquet")
    read, run = sp.read(tmp_path / "run"), sp.run(scenario)
    assert read == run and read.metrics == run.metrics and [case.name for case in read] == [case.name for case in run]
    assert read.scenario["text"] == scenario.read_text() and read.case(name="alone") == run.case("alone")
    with pytest.raises(KeyError, match="no case 'alon'; did you mean 'alone'"):
        read.case("alon")


def test_cases_of_equal_values_stay_apart(tmp_path):
    run = sp.run(SLIDE, sweep={"element.pad.alpha": [0.5, 0.5, 0.3, 0.5]}, out=tmp_path / "run")
    read = sp.read(tmp_path / "run")
    same(read, run)
    assert read.events["t"].tolist() == run.events["t"].tolist() and len(read.events) == len(run.events) == 4


def test_a_run_that_was_broken_off_has_the_cases_that_it_began(tmp_path):
    program = f"""
import springpot as sp, os, signal
def progress(share):
    if share > 0.3:
        os.kill(os.getpid(), signal.SIGINT)
sp.sweep({SLIDE!r}, {{"time.output_step": 1e-3}}, {{"element.pad.alpha": [0.2 + 0.001 * k for k in range(200)]}}, out={str(tmp_path / "run")!r}, jobs=1, progress=progress)
"""
    subprocess.run([sys.executable, "-c", program], capture_output=True, timeout=100)
    assert json.loads((tmp_path / "run/run.json").read_text())["status"] == "interrupted"
    read = sp.read(tmp_path / "run")
    assert 0 < len(read) < 200 and read.case(0).rows == 1001 and read.case(0).error is None
    assert list(read.failures) in ([], [read.case(-1).index]) and all("interrupted" in str(error) for error in read.failures.values())


def test_what_is_missing_or_damaged_is_told(named, tmp_path):
    _, whole = named
    with pytest.raises(sp.SpringpotError, match="nowhere: there is no such folder") as none:
        sp.read(tmp_path / "nowhere")
    assert isinstance(none.value, FileNotFoundError)
    with pytest.raises(sp.SpringpotError, match="has no run.json"):
        sp.read(tmp_path)

    def changed(name, change, match):
        folder = tmp_path / "changed"
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(whole, folder)
        text = change((folder / name).read_text())
        if text is None:
            (folder / name).unlink()
        else:
            (folder / name).write_text(text)
        with pytest.raises(sp.SpringpotError, match=match):
            sp.read(folder)

    lines = lambda count: lambda text: "".join(text.splitlines(keepends=True)[:count])
    changed("results.csv", lambda text: None, "results.csv: .*No such file")
    changed("results.csv", lines(150), "results.csv: it holds 48 rows of case 1, where run.json tells of 101")
    changed("results.csv", lines(102), "results.csv: it holds no row of case 1")
    changed("results.csv", lambda text: text + text.splitlines()[-1] + "\n", "results.csv: it holds more cases than run.json tells of")
    changed("results.csv", lambda text: text.replace("q.x", "q.y", 1), 'results.csv: it has a column "q.y" where run.json tells of "q.x"')
    changed("results.csv", lambda text: text.replace("\n0,", "\n7,", 1), 'results.csv: the rows of case 0 begin with "7,0.3,2" where .* "0,0.3,2"')
    changed("metrics.csv", lambda text: None, "metrics.csv: .*No such file")
    changed("metrics.csv", lambda text: text.replace(",q.x,", ",q.x,x", 1), 'metrics.csv: "x.*" is no number')
    changed("events.csv", lambda text: text + "1,2\n", "events.csv: CSV error")
    changed("run.json", lambda text: text[:-30], "run.json: EOF while parsing")
    changed("run.json", lambda text: text.replace('"names"', '"names_"', 1).replace("{", '{"shard": 1, ', 1), "run.json|one part of a run")


def test_no_damage_brings_it_down(named, tmp_path):
    _, whole = named
    random = np.random.default_rng(5)
    folder = tmp_path / "damaged"
    for name in ("run.json", "results.csv", "metrics.csv", "events.csv", "gradient.csv"):
        bytes = (whole / name).read_bytes()
        for k in range(12):
            shutil.rmtree(folder, ignore_errors=True)
            shutil.copytree(whole, folder, ignore=shutil.ignore_patterns("figures"))
            torn = bytearray(bytes)
            if k % 2:
                at = random.integers(len(torn))
                torn[at : at + random.integers(1, 40)] = random.bytes(random.integers(0, 30))
            else:
                del torn[random.integers(len(torn)) :]
            (folder / name).write_bytes(torn)
            try:
                sp.read(folder)
            except (sp.SpringpotError, sp.SpringpotWarning) as error:
                assert "mistake of Springpot" not in str(error)


def test_other_versions_and_parts_are_told(named, tmp_path):
    run, whole = named
    shutil.copytree(whole, tmp_path / "old")
    record = tmp_path / "old/run.json"
    record.write_text(record.read_text().replace(f'"springpot": "{sp.__version__}"', '"springpot": "0.0.9"'))
    with pytest.warns(sp.SpringpotWarning, match="is of Springpot 0.0.9"):
        same(sp.read(tmp_path / "old"), run)
    (tmp_path / "grid.toml").write_text(SLIDE)
    command("run", tmp_path / "grid.toml", "--sweep", "element.pad.alpha=0.3,0.4", "--shard", "1/2", "--out", tmp_path / "part", "--quiet")
    with pytest.raises(sp.SpringpotError, match="one part of a run, and others are elsewhere: .*merge"):
        sp.read(tmp_path / "part")


def test_cases_by_swept_values(named):
    run, _ = named
    grid = sp.run(SLIDE, sweep={**GRID, "robot.body.mass.mass": list(np.arange(0.1, 0.65, 0.1))})
    assert grid.case(u=1, alpha=0.3, mass=0.3).index == grid.case({"element.pad.u": 1, "alpha": 0.1 + 0.2, "mass": "300 g"}).index
    assert grid.case(u=2, alpha=0.6, mass=0.6).parameters["robot.body.mass.mass"] == pytest.approx(0.6)
    assert run.case(alpha=0.6, name="on") is run.case(3) and run.case(u="1-4*t", mass=3).index == 5
    wrong = [
        ({"alpha": 0.31}, "no case has element.pad.alpha = 0.31; element.pad.alpha has 0.3, 0.6"),
        ({"alpa": 1}, "no swept path 'alpa'"),
        ({"u": 1, "mass": 0.1}, "2 cases have element.pad.u = 1, robot.body.mass.mass = 0.1: element.pad.alpha is 0.3, 0.6"),
        ({"u": 1, "mass": "0.1 s"}, "no case has"),
        ({"name": "on"}, "no case 'on'"),
    ]
    for values, message in wrong:
        with pytest.raises(KeyError, match=message):
            grid.case(**values)
    two = sp.run(SLIDE.replace("mass = 2\n", "mass = 2\ncom = [0, 0, 0]\n"), sweep={"element.pad.mu": [1, 2], "element.pad.alpha": [0.3, 0.4]})
    assert two.case(mu=2, alpha=0.4).index == 3
    with pytest.raises(TypeError, match="by its number, its name, or swept values"):
        two.case()
    with pytest.raises(TypeError, match="by its number, or by its name"):
        two.case(1, alpha=0.3)
    with pytest.raises(KeyError, match="no swept path 'alpha'; there are none"):
        sp.run(SLIDE).case(alpha=0.3)


def test_a_data_set_of_xarray(named, monkeypatch):
    xarray = pytest.importorskip("xarray")
    run, folder = named
    data = run.to_xarray()
    # A failing value ends in NaN, what moves together shares a dimension, names stand beside values.
    assert dict(data.sizes) == {"u": 3, "alpha_mass": 2, "t": 101} and data.alpha.dims == ("alpha_mass",)
    assert data.u_name.values.tolist() == ["off", "on", "failing"] and data.mass.values.tolist() == [2.0, 3.0]
    for index, case in enumerate(run):
        values = data["pad.force"].values[index // 2, index % 2]
        assert np.array_equal(values[: case.rows], case["pad.force"]) and np.isnan(values[case.rows :]).all()
    assert data["pad.force"].attrs["units"] == "N" and data.t.attrs["units"] == "s" and data.mass.attrs["units"] == "kg"
    assert data["metric(peak)"].sel(u="0").dims == ("alpha_mass",) and data["metric(peak)"].attrs["units"] == "m"
    assert xarray.testing.assert_identical(sp.read(folder).to_xarray(), data) is None
    one = sp.run(SLIDE).to_xarray()
    assert dict(one.sizes) == {"t": 101} and float(one["q.x"].interp(t=0.505)) > 0
    # An event that ends runs at times of their own.
    ends = SLIDE.replace('when = "v.x"', 'when = "v.x"\naction = "stop"').replace("end = 1\n", "end = 3\n")
    stopped = sp.run(ends, sweep={"element.pad.alpha": [0.3, 0.6]})
    rows = stopped.to_xarray()
    assert rows.t.dims == ("alpha", "row") and np.isnan(rows.t).any() == (len({case.rows for case in stopped}) > 1)
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(ModuleNotFoundError, match="pip install xarray"):
        run.to_xarray()
