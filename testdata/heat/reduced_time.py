"""Forces of shifted materials by quadrature of their memory integrals, 40 digits.

1/a_T = 1 + 0.8 sin 3t, so that xi = t + 0.8/3 (1 - cos 3t); by Arrhenius' law with 60 kJ/mol about 300 K that is
T = 1/(1/300 - R/E ln(1 + 0.8 sin 3t)). F = int_0^t k(xi(t) - xi(s)) x'(s) ds with
  springpot  k = c xi^-alpha / Gamma(1 - alpha)
  zener      k = k_e + k_m E_1/2(-(xi/tau)^1/2), tau^1/2 = c/k_m, E_1/2(-z) = e^(z^2) erfc z
under x = 0.1 sin 5t, and clamped, where the law sees x = -b (T - 300), b = 2 mm/K.
"""
import json
from mpmath import mp, mpf, sin, cos, exp, log, erfc, gamma, quad, sqrt, diff

mp.dps = 40
R, ENERGY, REFERENCE, B = mpf("8.31446261815324"), mpf(60000), mpf(300), mpf("0.002")


def xi(t):
    return t + mpf("0.8") / 3 * (1 - cos(3 * t))


def temperature(t):
    return 1 / (1 / REFERENCE - R / ENERGY * log(1 + mpf("0.8") * sin(3 * t)))


def warming(t):
    pace = 1 + mpf("0.8") * sin(3 * t)
    return temperature(t) ** 2 * R / ENERGY * mpf("2.4") * cos(3 * t) / pace


def springpot(alpha):
    return lambda lag: 50 * lag**-alpha / gamma(1 - alpha)


def zener(lag):
    z = sqrt(lag) * 100 / 30
    return 20 + 100 * exp(z * z) * erfc(z)


def force(kernel, rate, t, panels):
    # s = t - u^8 takes the singularity away; xi(t) - xi(s) without loss of digits.
    def lag(back):
        return back + mpf("0.8") / 3 * 2 * sin(3 * back / 2) * sin(3 * (2 * t - back) / 2)

    top = t ** mpf("0.125")
    points = [top * k / panels for k in range(panels + 1)]
    return quad(lambda u: kernel(lag(u**8)) * rate(t - u**8) * 8 * u**7, points)


def main():
    moved = lambda s: mpf("0.5") * cos(5 * s)
    clamped = lambda s: -B * warming(s)
    assert abs(diff(temperature, mpf("0.7")) - warming(mpf("0.7"))) < mpf("1e-15")
    times = ["0.05", "0.5", "1", "2", "4"]
    cases = []
    for name, kernel in [
        ("springpot 0.3", springpot(mpf("0.3"))),
        ("springpot 0.8", springpot(mpf("0.8"))),
        ("zener", zener),
    ]:
        for motion, rate in [("moved", moved), ("clamped", clamped)]:
            values, check = [], mpf(0)
            for t in times:
                value, other = force(kernel, rate, mpf(t), 12), force(kernel, rate, mpf(t), 19)
                check = max(check, abs(value - other) / abs(value))
                values.append(mp.nstr(value, 24))
            assert check < mpf("1e-25")
            print(name, motion, mp.nstr(check, 3), values)
            cases.append({"law": name, "motion": motion, "force": values})
    with open("reduced_time.json", "w") as file:
        json.dump({"meta": " ".join(__doc__.split()), "times": times, "cases": cases}, file, indent=0)
        file.write("\n")


main()
