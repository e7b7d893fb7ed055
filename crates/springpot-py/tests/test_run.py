"""Runs in memory and in folders: the same numbers as the command, to the bit."""

import csv
import json
import pickle
import signal
import subprocess
import sys
import threading
import time
import warnings
from pathlib import Path

import numpy as np
import pytest

import springpot as sp

SCENARIOS = Path(__file__).parents[3] / "scenarios"

SLIDE = """
[robot]
gravity = [0, 0, 0]
[[robot.body]]
name = "mass"
joint = { name = "x", kind = "prismatic", axis = [1, 0, 0] }
mass = 2
[[element]]
name = "pad"
joint = "x"
law = "magnetorheological"
parameters = { E_c = 100, mu_0 = 4, mu = 2, alpha = 0.6 }
inputs = { u = 1 }
[motion]
kind = "forward"
torque = { x = "5*sin(3*t)" }
[time]
end = 1
output_step = 0.01
[[event]]
name = "turn"
when = "v.x"
[[metric]]
name = "peak"
of = "q.x"
kind = "max"
[[figure]]
name = "force"
y = ["pad.force"]
"""

GRID = {"element.pad.u": [0, 1, 2], "element.pad.alpha": [0.3, 0.6]}


def command(*arguments):
    """The command in a process of its own, as a user has it: it takes the signals of its process for itself."""
    done = subprocess.run([sys.executable, "-m", "springpot", *map(str, arguments)], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr


def files(folder):
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(Path(folder).rglob("*"))
        if path.is_file() and path.name != "run.json"
    }


def test_a_run_has_columns_units_metrics_events_and_summary():
    run = sp.run(SLIDE)
    assert run.cases[0].index == 0 and len(run) == 1 and run.units["pad.force"] == "N"
    t, q = run["t"], run["q.x"]
    assert t.shape == (101,) and t.dtype == np.float64 and not t.flags.writeable and t.flags.c_contiguous
    assert run["t"] is t and run.case(0)["t"] is t
    assert run.metrics["peak"] == q.max() and run.metrics[0]["unit"] == "m"
    assert all(row["event"] == "turn" for row in run.events) and abs(run.events["v.x"]).max() < 1e-9
    rows = {row["column"]: row for row in run.summary}
    assert rows["q.x"]["max"] == q.max() and rows["pad.force"]["unit"] == "N"
    with pytest.raises(KeyError, match="did you mean 'pad.force'"):
        run["pad.forc"]


def test_a_sweep_has_cases_in_the_order_of_the_grid():
    run = sp.run(SLIDE, sweep=GRID, jobs=2)
    assert [case.parameters for case in run.cases[:3]] == [
        {"element.pad.u": 0.0, "element.pad.alpha": 0.3},
        {"element.pad.u": 0.0, "element.pad.alpha": 0.6},
        {"element.pad.u": 1.0, "element.pad.alpha": 0.3},
    ]
    with pytest.raises(sp.SpringpotError, match="6 cases"):
        run["t"]
    assert run.metrics["peak"].shape == (6,)
    one = sp.run(SLIDE, set={"element.pad.u": 2, "element.pad.alpha": 0.6})
    assert np.array_equal(run.case(5)["pad.force"], one["pad.force"])


def test_paths_may_move_together():
    run = sp.run(SLIDE, sweep={("element.pad.u", "element.pad.alpha"): [(0, 0.3), ("2 V", 0.6)]})
    assert [list(case.parameters.values()) for case in run.cases] == [[0.0, 0.3], [2.0, 0.6]]


@pytest.mark.parametrize("scenario", sorted(SCENARIOS.glob("*.toml")), ids=lambda path: path.stem)
def test_shipped_scenarios_are_those_of_the_command_to_the_last_bit(scenario, tmp_path):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        run = sp.run(scenario)
        command("run", scenario, "--out", tmp_path / "command", "--no-figures", "--quiet")
        table = run.table()
        with open(tmp_path / "command" / "results.csv") as file:
            rows = csv.reader(file)
            assert next(rows) == list(table)
            written = list(zip(*rows))
        for (name, values), cells in zip(table.items(), written):
            if values.dtype.kind == "f":
                read = np.array([float(cell) if cell else np.nan for cell in cells])
                assert np.array_equal(read, values, equal_nan=True), name
            else:
                assert list(values) == list(cells)


@pytest.mark.parametrize("format", ["csv", "parquet", "npz"])
def test_folders_are_those_of_the_command(tmp_path, format):
    scenario = tmp_path / "slide.toml"
    scenario.write_text(SLIDE)
    sweeps = [f"--sweep={path}={','.join(map(str, values))}" for path, values in GRID.items()]
    command("run", scenario, *sweeps, "--out", tmp_path / "a", "--format", format, "--quiet")
    run = sp.run(scenario, sweep=GRID, out=tmp_path / "b", format=format)
    run.save(tmp_path / "c", format=format)
    pickle.loads(pickle.dumps(run)).save(tmp_path / "d", format=format)
    wanted = files(tmp_path / "a")
    assert "figures/force.svg" in wanted and "metrics.csv" in wanted
    for folder in "bcd":
        assert files(tmp_path / folder) == wanted, folder


def test_failures_are_recorded_in_a_sweep_and_raised_alone():
    run = sp.run(SLIDE, sweep={"element.pad.u": [1, "1-4*t"]})
    # mu_0 + u·mu is negative from t = 0.75 on.
    failed = run.failures[1]
    assert list(run.failures) == [1] and f"t = {failed.t} s" in str(failed) and 0.75 < failed.t < 0.76
    assert run.case(1)["t"][-1] <= failed.t
    assert "failed" in repr(run.case(1)) and run.case(0).error is None
    with pytest.raises(sp.RunError) as raised:
        sp.run(SLIDE, set={"element.pad.u": "1-4*t"})
    assert raised.value.t == failed.t
    with pytest.raises(sp.RunError) as raised:
        sp.run(SLIDE, set={"element.pad.u": "1-4*t", "time.output_step": 1})
    # The only row is at t = 0.
    assert 0.75 < raised.value.t < 1 and f"t = {raised.value.t} s" in str(raised.value)


def test_a_failure_is_when_it_happened_in_a_folder_too(tmp_path):
    for u in ["1-4*t", "-3"]:
        times = []
        for words in ({}, {"out": tmp_path / u}):
            with pytest.raises(sp.RunError) as raised:
                sp.run(SLIDE, set={"element.pad.u": u, "time.output_step": 1}, **words)
            times.append(raised.value.t)
        assert times[0] == times[1] and (0.75 < times[0] < 1 if "t" in u else times[0] == 0)


@pytest.mark.parametrize(
    ("words", "error"),
    [
        ({"set": {"element.pad.u": float("nan")}}, ValueError),
        ({"set": {"element.pad.nothing": 1}}, sp.ScenarioError),
        ({"set": ["element.pad.u=1"]}, TypeError),
        ({"sweep": {"element.pad.u": 3}}, TypeError),
        ({"sweep": {"element.pad.u": []}}, ValueError),
        ({"sweep": {("element.pad.u", "element.pad.alpha"): [(1, 2, 3)]}}, ValueError),
        ({"sweep": {"element.nothing.u": [1]}}, sp.ScenarioError),
        ({"jobs": 0}, ValueError),
        ({"jobs": -1}, ValueError),
        ({"jobs": True}, ValueError),
        ({"out": "/dev/null/x"}, sp.SpringpotError),
        ({"out": "x", "format": "xls"}, ValueError),
        ({"progress": 3}, TypeError),
    ],
)
def test_bad_input_is_a_clean_exception(words, error):
    with pytest.raises(error):
        sp.run(SLIDE, **words)


def test_progress_is_told_and_its_exceptions_come_through(capsys):
    shares = []
    sp.run(SLIDE, sweep={"time.end": [1, 2, 3]}, progress=shares.append)
    assert shares == sorted(shares) and 0 < shares[-1] <= 1

    class Mine(Exception):
        pass

    def fail(share):
        raise Mine

    with pytest.raises(Mine):
        sp.run(SLIDE, progress=fail)


# Nine million steps, a minute or more.
ENDLESS = {"time.end": 90, "time.output_step": 0.1, "solver.max_step": 1e-5}


def test_ctrl_c_ends_a_long_run():
    begun = time.process_time()

    def once_it_works():
        while time.process_time() - begun < 0.2:
            time.sleep(0.01)
        signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        threading.Thread(target=once_it_works, daemon=True).start()
        sp.run(SLIDE, set=ENDLESS)
    assert time.process_time() - begun < 10


def test_what_has_ended_is_put_before_an_exception_goes_on(tmp_path):
    class Enough(Exception):
        pass

    def enough(share):
        if share > 0.3:
            raise Enough

    # One case at a time: the last of them has no end.
    steps = {"solver.max_step": [1e-3, 1e-2, 1e-6]}
    with pytest.raises(Enough):
        sp.run(SLIDE, set={"time.end": 90, "time.output_step": 0.1}, sweep=steps, jobs=1, out=tmp_path / "out", progress=enough)
    assert "results.csv" in (names := {path.name for path in (tmp_path / "out").iterdir()}) and not names & {".unfinished", "results.csv.part"}
    record = json.loads((tmp_path / "out/run.json").read_text())
    assert record["status"] == "interrupted"
    assert [case["status"] for case in record["cases"]][:1] == ["done"]


def test_two_threads_run_at_once():
    wanted = sp.run(SLIDE)["q.x"]
    found = []
    threads = [threading.Thread(target=lambda: found.append(sp.run(SLIDE, jobs=1)["q.x"])) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 4 and all(np.array_equal(q, wanted) for q in found)


def test_frames(tmp_path):
    run = sp.run(SLIDE, sweep={"element.pad.u": [0, 1]})
    for library, make in [("pandas", run.to_pandas), ("polars", run.to_polars)]:
        pytest.importorskip(library)
        frame = make()
        assert frame.shape == (202, 1 + len(run.columns))
        assert np.array_equal(np.asarray(frame["pad.force"])[101:], run.case(1)["pad.force"])


def test_a_figure_has_axes_with_units():
    matplotlib = pytest.importorskip("matplotlib")
    pytest.importorskip("matplotlib.pyplot")
    matplotlib.use("Agg")
    run = sp.run(SLIDE, sweep={"element.pad.alpha": [0.3, 0.6], "element.pad.u": ["0 V", "1+t"]})
    ax = run.plot("pad.force", x="pad.stroke")
    assert ax.get_ylabel().endswith("N") and ax.get_xlabel().endswith("m")
    assert [line.get_label() for line in ax.lines] == [f"α = {alpha}, u = {u}" for alpha in (0.3, 0.6) for u in ("0 V", "1+t")]
    assert np.array_equal(ax.lines[2].get_ydata(), run.case(2)["pad.force"])
    # What the cases do not differ by is not said, and what they all differ by stands above.
    ax = run.plot("pad.force", cases=[0, 2])
    assert [text.get_text() for text in ax.get_legend().texts] == ["0.3", "0.6"]
    assert ax.get_legend().get_title().get_text() == "α"
    assert run.plot("pad.force", cases=[1]).get_legend() is None
    # Beyond what a legend holds: a colour bar of what they differ by, else of their numbers.
    many = sp.run(SLIDE, sweep={"element.pad.alpha": list(np.linspace(0.3, 0.9, 13))})
    ax = many.plot("pad.force")
    assert ax.get_legend() is None and len(ax.figure.axes) == 2
    assert ax.figure.axes[1].get_ylabel() == "element.pad.alpha" and ax.figure.axes[1].get_ylim() == pytest.approx((0.3, 0.9))
    assert len({line.get_color() for line in ax.lines}) == 13
    two = sp.run(SLIDE, sweep={"element.pad.alpha": list(np.linspace(0.3, 0.9, 7)), "element.pad.u": [0, 1]})
    ax = two.plot(["pad.force", "pad.stroke"])
    assert ax.figure.axes[1].get_ylabel() == "case" and len(ax.get_legend().texts) == 2
    matplotlib.pyplot.close("all")


def test_columns_outlive_their_run():
    force = sp.run(SLIDE)["pad.force"]
    copy = force.copy()
    for _ in range(20):
        sp.run(SLIDE)
    assert np.array_equal(force, copy)
    with pytest.raises(ValueError):
        force[0] = 1


def test_cases_have_names_and_elements_that_are_not_enabled_empty_columns():
    sweep = '[[sweep]]\nparameter = "element.pad.enabled"\nvalues = [true, false]\nnames = ["on the pad", "free"]\n'
    run = sp.run(SLIDE + sweep)
    assert [case.name for case in run.cases] == ["on the pad", "free"]
    free = run.case("free")
    assert free is run.cases[1] and free.parameters == {"element.pad.enabled": "false"}
    assert np.isnan(free["pad.force"]).all() and not np.isnan(run.case("on the pad")["pad.force"]).any()
    # Without the pad the torque alone moves two kilograms: x = (5/2)(t/3 - sin(3t)/9).
    t = free["t"]
    assert np.allclose(free["q.x"], 2.5 * (t / 3 - np.sin(3 * t) / 9), rtol=0, atol=1e-9)
    with pytest.raises(KeyError, match="no case 'fre'; did you mean 'free'"):
        run.case("fre")
