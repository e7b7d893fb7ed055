"""Recordings of a run, read by the packages of others: every row, every value, to the bit."""

import csv
import json
import math
import struct
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("mcap")
pytest.importorskip("mcap_ros2")

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

SCENARIOS = Path(__file__).parents[3] / "scenarios"

BOUNCE = """
title = "A mass on a pad"
[[robot.body]]
name = "mass"
joint = { name = "x", kind = "prismatic", axis = [0, 0, 1] }
mass = 2
[[element]]
name = "pad"
joint = "x"
law = "springpot"
parameters = { c = 50, alpha = 0.5 }
[motion]
kind = "forward"
[motion.start.q]
x = 0.1
[time]
end = 1
output_step = 0.01
[[event]]
name = "falls"
when = "q.x - 0.05"
[[sweep]]
parameter = "element.pad.alpha"
values = [0.3, 0.6]
"""

# The first force is infinite: its cell is empty.
SINGULAR = """
[robot]
body = [{ name = "arm", joint = { name = "q1", kind = "revolute", axis = [0, 1, 0] }, mass = 1, com = [0.2, 0, 0] }]
[[element]]
name = "strut"
from = { body = "world", point = [0, 0, -0.3] }
to = { body = "arm", point = [0.3, 0, 0] }
rest_length = 0.3
law = "springpot"
parameters = { c = 50, alpha = 0.4 }
derivative = "riemann-liouville"
[motion]
kind = "prescribed"
joints = { q1 = "0.5*sin(2*t)" }
[time]
end = 1
output_step = 0.125
"""
OWN = {"bounce": BOUNCE, "singular": SINGULAR}


def command(*arguments):
    done = subprocess.run([sys.executable, "-m", "springpot", *map(str, arguments)], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    return done


def field(message, path):
    for part in path.replace("[", ".").replace("]", "").split("."):
        message = message[int(part)] if part.isdigit() else getattr(message, part)
    return message


def same(found, cell):
    """Bits of a number and of a cell of results.csv."""
    return math.isnan(found) if cell == "" else struct.pack("<d", found) == struct.pack("<d", float(cell))


def rows(folder, case):
    record = json.loads((folder / "run.json").read_text())
    swept = sum(len(sweep["parameters"]) for sweep in record["sweeps"])
    with (folder / "results.csv").open(newline="") as file:
        header, *cells = [row[swept:] for row in csv.reader(file)]
    first = sum(one["rows"] for one in record["cases"] if one["index"] < case)
    count = next(one["rows"] for one in record["cases"] if one["index"] == case)
    return header, cells[first : first + count]


@pytest.mark.parametrize(("scenario", "case"), [("bounce", 1), ("singular", 0), ("panda_drop", 0), ("bumper", 0), ("torsional_coupling", 0), ("tendon_finger", 0)])
def test_a_recording_holds_every_value_of_every_row(tmp_path, scenario, case):
    source = SCENARIOS / f"{scenario}.toml"
    if scenario in OWN:
        source = tmp_path / f"{scenario}.toml"
        source.write_text(OWN[scenario])
    results, file = tmp_path / "results", tmp_path / "run.mcap"
    command("run", source, "--out", results, "--no-figures", "--quiet")
    command("export", results, file, "--case", case)
    header, cells = rows(results, case)
    with file.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
        assert reader.get_header().profile == "ros2"
        metadata = {one.name: one.metadata for one in reader.iter_metadata()}
        messages = {}
        for _, channel, message, decoded in reader.iter_decoded_messages():
            messages.setdefault(channel.topic, []).append((message.log_time, decoded))
    places = metadata["springpot.columns"]
    assert set(places) == set(header) and metadata["springpot"]["case"] == str(case)
    events = messages.pop("/events", [])
    assert all(len(of) == len(cells) for of in messages.values())
    times = [round(float(row[header.index("t")]) * 1e9) for row in cells]
    for at, column in enumerate(header):
        topic, path = places[column].split(" ")
        for (time, message), row, t in zip(messages[topic], cells, times, strict=True):
            assert same(field(message, path), row[at]), (column, t)
            assert abs(time - t) <= 1
    for time, message in messages["/tf"]:
        parents = {one.child_frame_id: one.header.frame_id for one in message.transforms}
        assert len(parents) == len(message.transforms)
        roots = set(parents.values()) - set(parents)
        assert roots == {"world"}
        assert all(one.header.stamp.sec * 10**9 + one.header.stamp.nanosec == time for one in message.transforms)
    if scenario == "bounce":
        assert [decoded.name for _, decoded in events] == ["falls"]
    if scenario == "singular":
        assert any(cell == "" for row in cells for cell in row)
