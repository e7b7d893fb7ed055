"""Maps: coloured cells over two sweeps, of a scenario and of a run."""

import re

import numpy as np
import pytest

import springpot as sp
from test_run import SLIDE

GRID = SLIDE + """
[[sweep]]
parameter = "element.pad.alpha"
values = [0.6, 0.3, 0.45]
[[sweep]]
parameter = "element.pad.u"
values = [1, 2, "1-4*t"]
names = ["on", "strong", "failing"]
[[figure]]
name = "map"
title = "Peaks"
kind = "map"
x = "element.pad.alpha"
y = "element.pad.u"
z = "metric(peak)"
"""


def colours(figure):
    """Of the cells, in the order in which they are drawn, without those of the bar."""
    filled = re.findall(r'<(?:path|polygon)[^>]*fill="(#[0-9a-f]{6})"', figure.svg)
    return filled[: len(filled) - 96]


def test_a_map_has_a_cell_for_each_case_that_ended():
    run = sp.run(GRID)
    drawn, own = run.figures()["map"], run.map("metric(peak)", "alpha", "u", title="Peaks")
    # Columns stand in the order of their values, rows in that of the file; three cases failed.
    assert len(run.failures) == 3 and len(colours(own)) == 6 and colours(drawn) == colours(own)
    cells = np.array([[run.case(alpha=alpha, name=name).index for alpha in (0.3, 0.45, 0.6)] for name in ("on", "strong")])
    peaks = run.metrics["peak"][cells].ravel()
    assert colours(own)[int(peaks.argmin())] == "#0d0887" and colours(own)[int(peaks.argmax())] == max(colours(own))
    for words in ("Peaks", ">0.45<", ">failing<", ">peak, m<", ">α<"):
        assert words in own.svg and words in drawn.svg, words
    assert own.png.startswith(b"\x89PNG") and own.pdf.startswith(b"%PDF")


def test_a_map_shows_one_value_of_other_sweeps(tmp_path):
    run = sp.run(GRID.replace('name = "map"', 'name = "map"\nwhere = { "robot.body.mass.mass" = 3 }'), sweep={"robot.body.mass.mass": [2, 3]}, out=tmp_path / "run")
    own = run.map("metric(peak)", "alpha", "u", where={"mass": "3000 g"}, title="Peaks")
    assert colours(run.figures()["map"]) == colours(own) == colours(sp.read(tmp_path / "run").map("metric(peak)", "alpha", "u", where={"mass": 3}))
    over = run.map("rms(pad.force)", "mass", "alpha", where={"u": "strong"}, unit="mN", x_scale="log", size=("90 mm", "60 mm"))
    assert len(colours(over)) == 6 and "rms of force F of pad, mN" in over.svg and ">mass, kg<" in over.svg
    wrong = [
        (("metric(peak)", "alpha", "u"), {}, ValueError, "robot.body.mass.mass is swept too"),
        (("metric(peak)", "alpha", "alpha"), {}, ValueError, "swept together"),
        (("metric(peak)", "alpha", "u"), {"where": {"alpha": 0.3}}, ValueError, "over which the map is drawn"),
        (("metric(peek)", "alpha", "u"), {"where": {"mass": 3}}, KeyError, "did you mean 'peak'"),
        (("max(pad.farce)", "alpha", "u"), {"where": {"mass": 3}}, KeyError, "did you mean 'pad.force'"),
        (("peak", "alpha", "u"), {"where": {"mass": 3}}, ValueError, "write .metric"),
        (("metric(peak)", "alpa", "u"), {}, KeyError, "no swept path 'alpa'"),
        (("metric(peak)", "alpha", "u"), {"where": {"mass": 4}}, ValueError, "no case has"),
        (("metric(peak)", "alpha", "u"), {"where": {"mass": 3}, "unit": "N"}, ValueError, "different dimensions"),
        (("metric(peak)", "alpha", "u"), {"where": {"mass": 3}, "x_scale": "lag"}, ValueError, "a scale is"),
        (("metric(peak)", "alpha", "u"), {"where": {"mass": 3}, "size": ("20 mm", "20 mm")}, ValueError, "leaves no room"),
    ]
    for arguments, words, error, message in wrong:
        with pytest.raises(error, match=message):
            run.map(*arguments, **words)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('z = "metric(peak)"', 'z = "metric(peek)"', "no metric has this name"),
        ('z = "metric(peak)"', 'z = "max(pad.*)"', "matches several columns; a map takes one"),
        ('z = "metric(peak)"', "", "has no `z`"),
        ('y = "element.pad.u"', 'y = "element.pad.alpha"', "swept together"),
        ('y = "element.pad.u"', 'y = "element.pad.mu"', "which is not swept"),
        ('y = "element.pad.u"', 'y = "element.pad.u"\ny_scale = "log"', "no numbers, or have names"),
        ('y = "element.pad.u"', 'y = "element.pad.u"\ny_range = [1, 2]', "has no meaning where kind = .map"),
        ('kind = "map"', 'kind = "curves"', "`z` .* has no meaning where kind = .curves"),
        ('[[figure]]\nname = "map"', '[[sweep]]\nparameter = "element.pad.mu"\nvalues = [1, 2]\n[[figure]]\nname = "map"', "element.pad.mu is swept too"),
        ('[[figure]]\nname = "map"', '[[figure]]\nname = "map"\nwhere = { "element.pad.u" = "on" }', "over which it is drawn"),
    ],
)
def test_what_is_no_map_is_refused_with_its_place(old, new, message):
    text = GRID.replace(old, new)
    assert text != GRID
    with pytest.raises(sp.ScenarioError, match=message) as refused:
        sp.check(text)
    assert refused.value.line is not None and refused.value.line > 25
