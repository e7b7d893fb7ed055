"""Pages, figures and files of runs: view, report, figure, export."""

import inspect
import json
import re
import subprocess
import sys
import webbrowser
from pathlib import Path

import pytest

import springpot as sp

SCENARIO = Path(__file__).parents[3] / "scenarios" / "falling_piezo.toml"
# One value of its own sweep of the voltage.
SHORT = {"time.end": "0.1 s"}
VOLTAGE = {"element.stack.U": ["20 V"]}


@pytest.fixture(scope="module")
def run() -> sp.Run:
    return sp.run(SCENARIO, set=SHORT, sweep={**VOLTAGE, "element.stack.alpha": [0.3, 0.5]})


def data(page: Path) -> dict:
    found = re.search(r'id="data">(.*?)</script>', page.read_text(encoding="utf-8"), re.DOTALL)
    assert found
    return json.loads(found[1])


def test_view_writes_what_the_run_holds(run: sp.Run, tmp_path: Path) -> None:
    page = run.view(tmp_path / "a.html")
    assert page == tmp_path / "a.html"
    shown = data(page)
    assert [case["index"] for case in shown["cases"]] == [0, 1]
    assert shown["cases"][0]["rows"] == len(run.case(0)["t"])
    assert [case["index"] for case in data(run.view(tmp_path / "b.html", cases=[1]))["cases"]] == [1]
    with pytest.raises(ValueError, match="case 7 has no row"):
        run.view(tmp_path / "c.html", cases=[7])


def test_a_browser_is_asked_where_no_file_is_named(run: sp.Run, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    asked: list[str] = []
    monkeypatch.setattr(webbrowser, "open", lambda url: asked.append(url))
    page = run.view()
    assert asked == [page.resolve().as_uri()] and page.is_file()
    run.view(open=False)
    run.report(tmp_path / "r.html")
    assert len(asked) == 1
    run.report(tmp_path / "r.html", open=True)
    assert len(asked) == 2


def test_reports(run: sp.Run, tmp_path: Path) -> None:
    text = run.report(tmp_path / "r.html").read_text(encoding="utf-8")
    assert "<math" in text and "stack: force over stroke" in text and "time.end" in text
    other = sp.run(SCENARIO, set={**SHORT, "element.stack.alpha": 0.4}, sweep=VOLTAGE)
    text = run.report(tmp_path / "c.html", other=other).read_text(encoding="utf-8")
    assert "first and second" in text and "largest difference" in text


def test_export(run: sp.Run, tmp_path: Path) -> None:
    assert run.export(tmp_path / "a.glb", case=1) == []
    assert (tmp_path / "a.glb").read_bytes()[:4] == b"glTF"
    run.export(tmp_path / "a.mcap")
    assert (tmp_path / "a.mcap").read_bytes()[1:5] == b"MCAP"
    with pytest.raises(ValueError, match="there are .mcap, .glb, .gltf"):
        run.export(tmp_path / "a.txt")
    with pytest.raises(sp.SpringpotError, match="case 9"):
        run.export(tmp_path / "b.mcap", case=9)


def test_figures_are_those_of_the_command(run: sp.Run, tmp_path: Path) -> None:
    folder = tmp_path / "run"
    run.save(folder)
    for name, figure in run.figures().items():
        assert figure.svg == (folder / "figures" / f"{name}.svg").read_text(encoding="utf-8")
        assert figure.png == (folder / "figures" / f"{name}.png").read_bytes()
    look = ["--size=90mm,60mm", "--y-range=-10,10", "--label=stack.force=pull", "--legend=order"]
    arguments = ["plot", str(folder), "stack.force", "--unit=stack.force=kN", "--title=A title", *look]
    for ending in ("svg", "pdf"):
        subprocess.run([sys.executable, "-m", "springpot", *arguments, f"--out={tmp_path / 'a'}.{ending}"], check=True, stdout=subprocess.PIPE)
    figure = run.figure(
        "stack.force", units={"stack.force": "kN"}, title="A title", size=("90mm", "60mm"), y_range=(-10, 10), labels={"stack.force": "pull"}, legend="order"
    )
    assert figure.svg == (tmp_path / "a.svg").read_text(encoding="utf-8")
    assert figure.pdf == (tmp_path / "a.pdf").read_bytes()
    assert figure.save(tmp_path / "b.pdf").read_bytes() == figure.pdf
    assert figure._repr_svg_() == figure.svg
    with pytest.raises(ValueError, match="saved as .svg, .png, .pdf"):
        figure.save(tmp_path / "b.jpg")


def test_statistics_over_a_swept_parameter(run: sp.Run) -> None:
    figure = run.figure(["max(stack.force)", "rms(stack.force)"], "element.stack.alpha")
    assert "max of" in figure.svg and "α" in figure.svg
    for wrong, why in ((["max(stack.force)", "stack.force"], "no statistic"), ("max(stack.farce)", "matches no column"), ("metric(m)", "metrics.csv")):
        with pytest.raises(ValueError, match=why):
            run.figure(wrong, "element.stack.alpha")
    with pytest.raises(ValueError, match="90"):
        run.figure("stack.force", size=("90", "60"))
    with pytest.raises(TypeError, match="x_range"):
        run.figure("stack.force", x_range=3)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="no option 'xrange'; there are x_range"):
        run.figure("stack.force", xrange=(0, 1))
    with pytest.raises(ValueError, match="write linear or log"):
        run.figure("stack.force", x_scale="cubic")


def test_options_of_a_look_are_those_of_the_command(run: sp.Run) -> None:
    options = [name for name, one in inspect.signature(sp.Run.figure).parameters.items() if one.annotation == "Look"]
    assert {"x_range", "y_scale", "size", "labels", "legend", "window"} <= set(options) and "view" not in options
    said = subprocess.run([sys.executable, "-m", "springpot", "plot", "--help"], check=True, stdout=subprocess.PIPE, text=True).stdout
    look = said.split("Look of the figure:")[1].split("Examples:")[0]
    assert sorted(re.findall(r"--(?!no-)([a-z-]+)", look)) == sorted(name.replace("_", "-").replace("labels", "label") for name in options)
