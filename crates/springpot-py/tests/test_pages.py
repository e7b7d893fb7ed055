"""Pages and files of runs: view, report, export."""

import json
import re
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
