"""Commands as functions: check, modulus, fmu."""

import ctypes
import json
import subprocess
import sys
import zipfile

import numpy as np
import pytest

import springpot as sp
from conftest import ARM
from test_run import SLIDE, command

MAXWELL = SLIDE.replace('"magnetorheological"', '"fractional-zener"').replace(
    "parameters = { E_c = 100, mu_0 = 4, mu = 2, alpha = 0.6 }\ninputs = { u = 1 }",
    "parameters = { k_e = 100, k_m = 50, c = 4, alpha = 0.6 }",
)


def test_check_tells_what_a_run_goes_on_in_spite_of():
    assert sp.check(ARM) == []
    (far,) = sp.check(ARM.replace("point = [0, 0, -0.3]", "point = [0, 0, -300]").replace('"42 cm"', '"start"'))
    assert far.path == "<text>" and far.line == 14 and "300 m away from a robot" in far.message and str(far).startswith("<text>:14:")
    found = sp.check(ARM, set={"element.strut.rest_length": "10 cm"})
    assert found[0].path is None and "more than 20 %" in found[0].message and found[0].help.startswith("look at rest_length")
    with pytest.raises(sp.ScenarioError, match="did you mean") as refused:
        sp.check(ARM.replace("mass = 1", "mas = 1"))
    assert refused.value.line == 5
    with pytest.raises(sp.RunError, match="mu_0 \\+ u·mu ≥ 0"):
        sp.check(SLIDE, set={"element.pad.u": -3})


def test_check_says_what_the_command_says(tmp_path):
    (tmp_path / "arm.toml").write_text(ARM.replace("point = [0.3, 0, 0]", "point = [0, 0, 0]"))
    told = subprocess.run([sys.executable, "-m", "springpot", "check", str(tmp_path / "arm.toml")], capture_output=True, text=True)
    findings = sp.check(tmp_path / "arm.toml")
    assert told.returncode == 0 and findings and told.stderr.count("warning") == len(findings)
    words = " ".join(told.stderr.replace("│", " ").split())
    assert all(" ".join(finding.message.split()) in words for finding in findings)


def test_modulus_is_that_of_the_law_and_of_the_command(tmp_path):
    hertz = np.geomspace(0.1, 100, 7)
    found = sp.modulus(MAXWELL, "pad", frequencies=hertz)
    law = sp.law("fractional-zener", k_e=100, k_m=50, c=4, alpha=0.6)
    assert np.allclose(found.complex, law.modulus(2 * np.pi * hertz), rtol=1e-12, atol=0) and found.unit == "N/m" and found.amplitude == 1e-3
    assert sp.modulus(MAXWELL, "pad", frequencies="60 rad/s").frequency[0] == pytest.approx(60 / (2 * np.pi))
    (tmp_path / "pad.toml").write_text(MAXWELL.replace('"fractional-zener"', '"parallel(spring(k), friction(f))"').replace(
        'law = "parallel(spring(k), friction(f))"\nparameters = { k_e = 100, k_m = 50, c = 4, alpha = 0.6 }',
        'network = "parallel(spring(k), jenkins(k_f, F_y))"\nparameters = { k = 100, k_f = 50, F_y = 0.1 }',
    ))
    command("modulus", tmp_path / "pad.toml", "pad", "--amplitude", "1 mm,1 cm", "--from", "1", "--to", "10", "--points", "3", "--out", tmp_path / "m.json")
    told = json.loads((tmp_path / "m.json").read_text())
    found = sp.modulus(tmp_path / "pad.toml", "pad", ["1 mm", 0.01], frequencies=told["frequency"][:3])
    for name in ("storage", "loss", "tan_delta", "cycle"):
        assert np.array_equal(getattr(found, name).ravel(), told[name]), name
    assert found.storage.shape == (2, 3) and found.amplitude.tolist() == [1e-3, 1e-2] and found.loss[0, 0] < found.loss[1, 0]
    assert "2 amplitudes" in repr(found) and found._repr_html_().count("<tr>") == 7
    wrong = [
        (dict(element="pat", frequencies=1), 'there is no element "pat"; did you mean `pad`'),
        (dict(element="pad", frequencies=0), "0 is no frequency above 0"),
        (dict(element="pad", frequencies="3 1/s"), "whether turns"),
        (dict(element="pad", frequencies=1, amplitude=-1), "-1 is no stroke above 0"),
        (dict(element="pad", frequencies=1), "depends on the amplitude; give amplitude"),
        (dict(element="pad", frequencies=[]), "no frequencies"),
    ]
    for words, message in wrong:
        with pytest.raises(ValueError, match=message):
            sp.modulus(tmp_path / "pad.toml", **words)


def test_an_fmu_is_written_and_its_library_loads(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "slide.toml").write_text(SLIDE)
    with pytest.warns(sp.SpringpotWarning, match='event \'turn\' is not in the FMU'):
        path = sp.fmu("slide.toml")
    assert path.name == "slide.fmu"
    with zipfile.ZipFile(path) as archive:
        names = archive.namelist()
        (library,) = [name for name in names if name.startswith("binaries/")]
        archive.extract(library, tmp_path)
        description = archive.read("modelDescription.xml").decode()
    loaded = ctypes.CDLL(str(tmp_path / library))
    loaded.fmi2GetVersion.restype = ctypes.c_char_p
    assert loaded.fmi2GetVersion() == b"2.0" and 'fmiVersion="2.0"' in description and 'name="pad.force"' in description
    fmpy = pytest.importorskip("fmpy")
    run = sp.run(SLIDE)
    told = fmpy.simulate_fmu(str(path), stop_time=1.0, output_interval=0.01, output=["q.x", "pad.force"])
    assert np.allclose(told["pad.force"], run["pad.force"], atol=1e-8)


def test_what_cannot_be_an_fmu_is_refused(tmp_path):
    with pytest.raises(ValueError, match="is no .fmu"):
        sp.fmu(SLIDE, tmp_path / "slide.zip")
    with pytest.raises(ValueError, match="the scenario has 2 cases"):
        sp.fmu(SLIDE + '[[sweep]]\nparameter = "element.pad.u"\nvalues = [0, 1]\n', tmp_path / "slide.fmu")
    (tmp_path / "no.so").write_bytes(b"\x7fELF")
    with pytest.raises(ValueError, match="no.so is not the library of this version"):
        sp.fmu(SLIDE, tmp_path / "slide.fmu", library=tmp_path / "no.so")
    with pytest.raises(sp.ScenarioError):
        sp.fmu(SLIDE, tmp_path / "slide.fmu", set={"element.pad.alpha": 3})
    assert not (tmp_path / "slide.fmu").exists()
