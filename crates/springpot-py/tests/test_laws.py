"""Laws, Prony series, data sheets."""

from __future__ import annotations

import math
import pickle
import re

import numpy as np
import pytest

import springpot as sp


def test_laws() -> None:
    names = [row["name"] for row in sp.laws()]
    assert len(set(names)) == len(names) and {"springpot", "prony", "spencer", "zener"} <= set(names)
    row = next(row for row in sp.laws() if row["name"] == "thermoviscoelastic")
    assert [parameter["name"] for parameter in row["parameters"]][:3] == ["E_c", "E_kv", "E_d"]
    assert row["inputs"][0]["unit"] == "K"


def test_parameters_have_units() -> None:
    law = sp.law("springpot", c="0.5 N*s^alpha/cm", alpha=0.3)
    assert law.parameters == {"c": 50.0, "alpha": 0.3} and law.units == {"c": "N*s^alpha/m", "alpha": ""}
    assert sp.law("springpot", c="0.5 N*s^0.3/cm", alpha=0.3).parameters == law.parameters
    for bad in ({"c": "1 N/m", "alpha": 0.3}, {"c": -1, "alpha": 0.3}, {"c": math.inf, "alpha": 0.3}, {"c": 1, "alpha": 0.3, "k": 1}):
        with pytest.raises(ValueError):
            sp.law("springpot", **bad)
    with pytest.raises(TypeError):
        sp.law("springpot", c=[1], alpha=0.3)
    with pytest.raises(ValueError, match="caputo"):
        sp.law("springpot", c=1, alpha=0.3, derivative="weyl")
    with pytest.raises(ValueError, match="one of E_c|positive"):
        sp.law("magnetorheological", E_c=0, mu_0=0, mu=0, alpha=0.3)


def test_modulus_and_relaxation() -> None:
    omega, t = np.logspace(-2, 3, 7), np.logspace(-2, 2, 7)
    pot = sp.law("springpot", c=50.0, alpha=0.3)
    np.testing.assert_allclose(pot.modulus(omega), 50 * (1j * omega) ** 0.3, rtol=1e-12)
    np.testing.assert_allclose(pot.relaxation(t), 50 * t**-0.3 / math.gamma(0.7), rtol=1e-8)
    zener = sp.law("fractional-zener", k_e=10, k_m=90, c=5, alpha=0.5)
    arm = 1 / (1 / 90 + 1 / (5 * (1j * omega) ** 0.5))
    np.testing.assert_allclose(zener.modulus(omega), 10 + arm, rtol=1e-12)
    relaxed = 10 + 90 * sp.fractional.mittag_leffler(-18 * t**0.5, 0.5)
    np.testing.assert_allclose(zener.relaxation(t), relaxed, rtol=1e-8)
    assert zener.modulus(omega.reshape(7, 1)).shape == (7, 1)
    assert sp.law("spring", k=3).relaxation([1.0]) == [3.0]
    damper = sp.law("magnetorheological", E_c=1, mu_0=2, mu=3, alpha=0)
    assert damper.modulus([1.0], {"u": "2 V"})[0].real == pytest.approx(9.0)
    with pytest.raises(ValueError, match="a dashpot"):
        sp.law("dashpot", c=1).relaxation([1.0])
    with pytest.raises(ValueError, match="not linear"):
        sp.law("bouc-wen", alpha_h=1, A=1, beta=1, gamma=1, n=1).modulus([1.0])


def test_networks() -> None:
    mount = sp.network("series(glass: spring(k0), parallel(springpot(c, alpha), dashpot(eta)))", k0="9 N/mm", c=40, alpha=0.4, eta=3)
    assert mount.leaves == ["glass", "springpot1", "dashpot1"] and mount.parameters["k0"] == 9000.0 and mount.is_linear
    with pytest.raises(ValueError, match=r"character 8.*spring"):
        sp.network("series(sprin(k))", k=1)
    table = sp.network("table(pad)", pad=([-1.0, 0.0, 1.0], [-2.0, 0.0, 2.0]))
    bank = sp.Bank([table], nodes="end")
    bank.begin([0.0])
    assert bank.evaluate(0, 1, [0.5])[0][0, 0] == pytest.approx(1.0)
    with pytest.raises(ValueError, match="pad"):
        sp.network("table(pad)", pad=([0.0], [0.0]))
    prony = sp.law("prony", k_e=1, k=[2.0, 3.0], tau=["10 ms", 1.0])
    assert prony.parameters == {"k_e": 1.0, "k": [2.0, 3.0], "tau": [0.01, 1.0]}
    with pytest.raises(ValueError, match="as many"):
        sp.law("prony", k_e=1, k=[2.0, 3.0], tau=[1.0])


def test_expressions() -> None:
    said = sp.network("parallel(expression(f), spring(k))", f="b*x^3 + c*v", b="5 MN/m^3", c=2.0, k="3 kN/m")
    assert said.parameters == {"k": 3000.0, "b": 5e6, "c": 2.0, "f": "b*x^3 + c*v"}
    assert said.units == {"k": "N/m", "b": "N/m^3", "c": ""} and said.leaves == ["expression1", "spring1"]
    assert pickle.loads(pickle.dumps(said)) == said
    inline = sp.network("expression('k*x + c*v', k, c)", k=3.0, c=2.0)
    assert np.array_equal(inline.modulus([0.0, 10.0]), sp.law("kelvin-voigt", k=3.0, c=2.0).modulus([0.0, 10.0]))
    for text, given, words in [
        ("expression(f)", {"k": 3.0}, 'the expression "f" is missing'),
        ("expression(f)", {"f": 3.0}, "f must be a text"),
        ("expression(f)", {"f": "k*x*t"}, "f, character 5: `t` has no place"),
        ("expression(f)", {"f": "k*x"}, 'the parameter "k" is missing'),
        ("expression(f)", {"f": "k*x", "k": "3 bananas"}, "bananas"),
        ("expression('k*x')", {"k": 3.0}, "is not named behind the expression"),
    ]:
        with pytest.raises((ValueError, TypeError), match=re.escape(words)):
            sp.network(text, **given)


@pytest.mark.parametrize(
    "law",
    [
        sp.law("springpot", c=3, alpha=0.4, derivative="riemann-liouville"),
        sp.network("series(spring(k), dashpot(c))", k=1, c=2),
        sp.law("prony", k_e=1, k=[2.0, 3.0], tau=[0.1, 1.0]),
        sp.network("table(pad)", pad=([0.0, 1.0], [0.0, 2.0])),
    ],
)
def test_laws_are_picklable(law: sp.Law) -> None:
    copy = pickle.loads(pickle.dumps(law))
    assert repr(copy) == repr(law) and copy.description == law.description and sp.Law(law).parameters == law.parameters
    assert sp.Law(law.description).parameters == law.parameters


def test_prony_series() -> None:
    pot = sp.law("springpot", c=50.0, alpha=0.5)
    t = np.logspace(-3, 1, 200)
    series = sp.prony(pot, ("1 ms", 10), rtol=1e-5)
    assert np.abs(series.relaxation(t) / pot.relaxation(t) - 1).max() <= 1.01e-5 and series.error <= series.rtol == 1e-5
    assert (series.moduli > 0).all() and (np.diff(series.times) > 0).all() and len(series) == len(series.times)
    band = sp.prony(pot, band=("1 Hz", "100 Hz"))
    omega = 2 * math.pi * np.logspace(0, 2, 100)
    assert (np.abs(band.modulus(omega) - pot.modulus(omega)) / np.abs(pot.modulus(omega))).max() <= 1.01e-4
    assert series.csv().count("\n") >= len(series)
    assert "PRONY" in sp.prony(pot, (1e-3, 10), slowest="stays").abaqus().upper()
    law = sp.law("prony", k_e=series.equilibrium, k=series.moduli, tau=series.times)
    np.testing.assert_allclose(law.modulus(omega), series.modulus(omega), rtol=1e-12)
    for bad in ({}, {"times": (1, 2), "band": (1, 2)}, {"times": (2, 1)}, {"times": (1, 2), "rtol": 1}, {"times": (1, 2), "slowest": "x"}):
        with pytest.raises(ValueError):
            sp.prony(pot, **bad)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="needs no series"):
        sp.prony(sp.law("maxwell", k=1, c=1), (1, 2))


def test_data_sheets() -> None:
    law, deviation = sp.datasheet([("stiffness", "5 kN/m", 0), ("stiffness", 6000, "10 Hz"), ("tan_delta", 0.2, 62.83185307179586)])
    assert law.name == "fractional-kelvin-voigt" and deviation < 1e-6
    assert abs(law.modulus(2 * math.pi * 10)) == pytest.approx(6000)
    with pytest.raises(ValueError, match="tan_delta"):
        sp.datasheet([("tan_delt", 0.2, 0)])
    with pytest.raises(ValueError):
        sp.datasheet([("stiffness", -1, 0)])
    omega = np.logspace(0, 3, 30)
    exact = sp.law("fractional-kelvin-voigt", k=300, c=20, alpha=0.35)
    found, rms, spread = sp.fit(omega, exact.modulus(omega))
    assert found.parameters["alpha"] == pytest.approx(0.35) and rms < 1e-10 and set(spread) == {"k", "c", "alpha"}


def test_moduli_are_those_of_a_sample() -> None:
    sample = {"area": "4 cm^2", "length": 0.01}
    of_sample, _ = sp.datasheet([("storage", "2 MPa", "10 Hz"), ("tan_delta", "10 deg", "10 Hz")], **sample)
    told, _ = sp.datasheet([("storage", 8e4, "10 Hz"), ("tan_delta", math.tan(math.radians(10)), "10 Hz")])
    assert of_sample.parameters == pytest.approx(told.parameters, rel=1e-12)
    omega = np.logspace(-1, 3, 40)
    exact = sp.law("zener", k_e=300, k_m=900, c=20)
    found, rms, spread = sp.fit(omega, exact.modulus(omega) / 0.04, "zener", **sample)
    assert found.parameters == pytest.approx(exact.parameters, rel=1e-6) and rms < 1e-8 and set(spread) == {"k_e", "k_m", "c"}
    for words, message in [
        ({}, "area and the length"),
        ({"area": 1.0}, "give both"),
        ({"area": -1.0, "length": 1.0}, "must be positive"),
        ({"area": "1 m", "length": 1.0}, "area"),
    ]:
        with pytest.raises(ValueError, match=message):
            sp.datasheet([("storage", "2 MPa", "10 Hz"), ("tan_delta", 0.1, "10 Hz")], **words)
    with pytest.raises(ValueError, match="no modulus"):
        sp.datasheet([("storage", 2e6, "10 Hz"), ("tan_delta", 0.1, "10 Hz")], **sample)
    with pytest.raises(ValueError, match="90 deg"):
        sp.datasheet([("storage", 2e6, "10 Hz"), ("tan_delta", "95 deg", "10 Hz")])


def test_units() -> None:
    assert sp.units.parse("25 degC", "K") == 298.15
    assert sp.units.convert(np.array([0.0, 100.0]), "degC", "degF").tolist() == pytest.approx([32.0, 212.0])
    for bad in ("25 m", "x", "", "nan K"):
        with pytest.raises(ValueError):
            sp.units.parse(bad, "K")
    with pytest.raises(ValueError, match="dimension"):
        sp.units.convert(1.0, "m", "s")
    with pytest.raises(TypeError):
        sp.units.parse([1], "K")  # type: ignore[arg-type]
