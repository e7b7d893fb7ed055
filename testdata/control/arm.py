"""The three-body arm of the papers under control, by other means: reference values for the tests of control.

The equations of motion are those of the Rodrigues face (mass matrix, Christoffel symbols in closed form, gravity) on NumPy arrays, integrated by
SciPy's DOP853 at rtol 1e-13 from one switch of the control to the next; switches are located by its own event search, sampled laws are held between
two samples. Nothing of Springpot is used.

    python arm.py > arm.csv
"""

import numpy as np
from scipy.integrate import solve_ivp

G = np.array([0.0, 0.0, -9.81])
AXES = [np.array([0.0, 0, 1]), np.array([0.0, 1, 0]), np.array([0.0, 1, 0])]
OFFSETS = [np.array([0.0, 0, 0]), np.array([0.0, 0, 0.6]), np.array([0.5, 0, 0])]
MASSES = [6.0, 3.0, 2.0]
COMS = [np.array([0.02, 0, 0.3]), np.array([0.25, 0.01, 0.02]), np.array([0.18, -0.01, 0.01])]
INERTIAS = [
    np.array([[0.20, 0, 0.01], [0, 0.20, 0], [0.01, 0, 0.06]]),
    np.array([[0.01, 0.001, 0], [0.001, 0.07, 0.0005], [0, 0.0005, 0.07]]),
    np.array([[0.006, 0, -0.001], [0, 0.03, 0.0004], [-0.001, 0.0004, 0.03]]),
]
GRIPPER = np.array([0.4, 0, 0])
# A spring and a dashpot between column and forearm.
D1, D3, REST, K, C = np.array([0.14, -0.1, 0.08]), np.array([-0.06, 0.1, 0.08]), 0.7, 400.0, 15.0


def cross(a, b):
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def turn(e, q):
    x = np.array([[0, -e[2], e[1]], [e[2], 0, -e[0]], [-e[1], e[0], 0]])
    return np.eye(3) + np.sin(q) * x + (1 - np.cos(q)) * x @ x


class Pose:
    """Where everything is at q, and M, h = Γq̇q̇, g = −Q_g."""

    def __init__(self, q, v):
        a, o, self.origins, self.rotations, self.e = np.eye(3), np.zeros(3), [], [], []
        for k in range(3):
            o = o + a @ OFFSETS[k]
            self.e.append(a @ AXES[k])
            a = a @ turn(AXES[k], q[k])
            self.origins.append(o)
            self.rotations.append(a)
        self.q, self.v = q, v
        columns = [[self.column(j, i, self.point(i, COMS[i])) for j in range(3)] for i in range(3)]
        om = [[self.e[j] if j <= i else np.zeros(3) for j in range(3)] for i in range(3)]
        world = [r @ m @ r.T for r, m in zip(self.rotations, INERTIAS)]
        self.mass, self.gravity, self.bias = np.zeros((3, 3)), np.zeros(3), np.zeros(3)
        for i in range(3):
            pi = 0.5 * np.trace(world[i]) * np.eye(3) - world[i]
            for j in range(3):
                self.gravity[j] -= MASSES[i] * G @ columns[i][j]
                for k in range(3):
                    self.mass[j, k] += MASSES[i] * columns[i][j] @ columns[i][k] + om[i][j] @ world[i] @ om[i][k]
            for b in range(3):
                for c in range(3):
                    lo, hi = min(b, c), max(b, c)
                    if hi > i:
                        continue
                    for d in range(3):
                        gamma = MASSES[i] * cross(self.e[lo], columns[i][hi]) @ columns[i][d]
                        gamma += om[i][lo] @ (pi @ cross(om[i][hi], om[i][d]))
                        self.bias[d] += gamma * v[b] * v[c]

    def point(self, body, p):
        return self.origins[body] + self.rotations[body] @ p

    def column(self, joint, body, r):
        return cross(self.e[joint], r - self.origins[joint]) if joint <= body else np.zeros(3)

    def element(self):
        """Stroke, rate, ∂l/∂q."""
        a, b = self.point(0, D1), self.point(2, D3)
        length = np.linalg.norm(b - a)
        n = (b - a) / length
        slope = np.array([n @ (self.column(j, 2, b) - self.column(j, 0, a)) for j in range(3)])
        return length - REST, slope @ self.v, slope

    def gripper(self):
        r = self.point(2, GRIPPER)
        jacobian = np.array([self.column(j, 2, r) for j in range(3)]).T
        return r, jacobian


def acceleration(pose, tau):
    x, rate, slope = pose.element()
    return np.linalg.solve(pose.mass, tau - pose.bias - pose.gravity - slope * (K * x + C * rate))


QUINTIC = [np.polynomial.Polynomial([0, 0, 0, 10, -15, 6])]
START, END, DURATION = np.array([0.0, 0.1, 0.2]), np.array([0.6, -0.2, 0.9]), 0.8


def move(t):
    """The reference: q_d, v_d, a_d."""
    s = QUINTIC[0]
    if t >= DURATION:
        return END, np.zeros(3), np.zeros(3)
    w = t / DURATION
    d = END - START
    return START + d * s(w), d * s.deriv()(w) / DURATION, d * s.deriv(2)(w) / DURATION**2


OPTIONS = dict(method="DOP853", rtol=1e-13, atol=1e-13, max_step=0.01)


def rows(name, times, q, v, extra):
    for t, q, v, tau in zip(times, q, v, extra):
        print(",".join([name, repr(float(t))] + [repr(float(x)) for x in [*q, *v, *tau]]))


def smooth(name, tau, times, start=(START, np.zeros(3))):
    """A law that is smooth but at DURATION."""

    def f(t, y):
        pose = Pose(y[:3], y[3:])
        return np.concatenate([y[3:], acceleration(pose, tau(t, pose))])

    y, t, out = np.concatenate(start), 0.0, {0.0: np.concatenate(start)}
    for stop in [DURATION, times[-1]]:
        if stop <= t:
            continue
        inside = [x for x in times if t < x <= stop]
        run = solve_ivp(f, (t, stop), y, t_eval=sorted(set(inside + [stop])), **OPTIONS)
        out.update(zip(run.t, run.y.T))
        t, y = stop, run.y[:, -1]
    states = [out[x] for x in times]
    rows(name, times, [s[:3] for s in states], [s[3:] for s in states], [tau(x, Pose(s[:3], s[3:])) for x, s in zip(times, states)])


def held(name, law, period, delay, times, errors_run_on=None):
    """A law that is sampled: law(t, pose, z) → (tau, keep), where z are integrals of errors, which run on while `keep` says so."""
    y, out = np.concatenate([START, np.zeros(6)]), {}
    waiting, tau, k, t = [], np.zeros(3), 0, 0.0
    count = int(round(times[-1] / period))
    while k <= count:
        said, windup = law(t, Pose(y[:3], y[3:6]), y[6:])
        waiting.append(said)
        if len(waiting) > delay:
            tau = waiting.pop(0)
        if any(abs(t - x) < 1e-12 for x in times):
            out[k] = (y.copy(), tau.copy())
        if k == count:
            break

        def f(s, y, tau=tau, windup=windup):
            pose = Pose(y[:3], y[3:6])
            e = move(s)[0] - y[:3]
            # The integrand is 0 while the force before its limit is outside and ki·e has its sign.
            run = np.where((windup != 0) & (windup * e > 0), 0.0, e)
            return np.concatenate([y[3:6], acceleration(pose, tau), run])

        stop = (k + 1) * period
        cuts = [stop]
        if t < DURATION < stop:
            cuts = [DURATION, stop]
        for cut in cuts:
            run = solve_ivp(f, (t, cut), y, **OPTIONS)
            t, y = cut, run.y[:, -1]
        k += 1
    keys = [int(round(x / period)) for x in times]
    rows(name, times, [out[k][0][:3] for k in keys], [out[k][0][3:6] for k in keys], [out[k][1] for k in keys])


def pid_in_modes(name, kp, ki, kd, limit, times):
    """PID with a limit and conditional anti-windup in continuous time, each joint by itself: free, frozen, or sliding along its limit."""
    n = 3
    state = np.concatenate([START, np.zeros(3), np.zeros(n)])
    mode = ["free"] * n
    side = [0.0] * n

    def parts(t, y):
        qd, vd, ad = move(t)
        pose = Pose(y[:3], y[3:6])
        e, de = qd - y[:3], vd - y[3:6]
        wanted = kp * e + kd * de + ki * y[6:]
        tau = wanted.copy()
        for j in range(n):
            if mode[j] != "free":
                tau[j] = side[j] * limit[j]
        a = acceleration(pose, tau)
        dde = ad - a
        return pose, e, de, wanted, tau, a, kp * de + kd * dde

    def f(t, y):
        _, e, _, _, _, a, drift = parts(t, y)
        run = np.zeros(n)
        for j in range(n):
            if mode[j] == "free" or mode[j] == "outside":
                run[j] = e[j]
            elif mode[j] == "sliding":
                run[j] = -drift[j] / ki[j]
        return np.concatenate([y[3:6], a, run])

    def guards(t, y):
        _, e, _, wanted, _, _, drift = parts(t, y)
        g = []
        for j in range(n):
            s = side[j]
            if mode[j] == "free":
                g += [(limit[j] - wanted[j], j, "above"), (limit[j] + wanted[j], j, "below")]
            elif mode[j] == "frozen":
                g += [(s * wanted[j] - limit[j], j, "back"), (s * e[j], j, "turn")]
            elif mode[j] == "outside":
                g += [(s * wanted[j] - limit[j], j, "back"), (-s * e[j], j, "turn")]
            else:
                run = -drift[j] / ki[j]
                g += [(s * run, j, "empty"), (s * (e[j] - run), j, "fill")]
        return g

    t, out, y, taus = 0.0, {0.0: state.copy()}, state, {}
    taus[0.0] = parts(0.0, state)[4]
    switches, modes = 0, []
    while t < times[-1]:
        stop = min(x for x in [*[x for x in times if x > t + 1e-13], DURATION if t < DURATION - 1e-13 else 1e9])
        events = []
        for k in range(len(guards(t, y))):
            event = lambda t, y, k=k: guards(t, y)[k][0]
            event.terminal, event.direction = True, -1
            events.append(event)
        run = solve_ivp(f, (t, stop), y, events=events, **OPTIONS)
        t, y = run.t[-1], run.y[:, -1]
        if run.status == 1:
            k = next(k for k, hit in enumerate(run.t_events) if len(hit))
            _, j, what = guards(t, y)[k]
            _, e, _, _, _, _, drift = parts(t, y)
            if what in ("above", "below"):
                side[j] = 1.0 if what == "above" else -1.0
                if side[j] * e[j] > 0:
                    mode[j] = "frozen" if side[j] * drift[j] >= 0 else "sliding"
                else:
                    mode[j] = "outside"
            elif what == "back":
                pushes = mode[j] == "frozen" and side[j] * (drift[j] + ki[j] * e[j]) > 0
                mode[j] = "sliding" if pushes else "free"
            elif what == "turn":
                mode[j] = "outside" if mode[j] == "frozen" else "frozen"
            else:
                mode[j] = "frozen" if what == "empty" else "free"
            switches += 1
            modes.append(f"{j + 1}:{mode[j]}")
        if any(abs(t - x) < 1e-13 for x in times):
            out[next(x for x in times if abs(t - x) < 1e-13)] = y.copy()
        taus[t] = parts(t, y)[4]
    states = [out[x] for x in times]
    print(f"# {name}: {switches} switches, joint by joint {' '.join(modes)}")
    found = [next(tau for t, tau in taus.items() if abs(t - x) < 1e-13) for x in times]
    rows(name, times, [s[:3] for s in states], [s[3:6] for s in states], found)



def pd_with_rates(name, kp, kd, most, limit, times):
    """PD with gravity whose forces change no faster than `most` and are bounded by `limit` after that."""
    n = 3
    y, mode, since, start = np.concatenate([START, np.zeros(3)]), [0.0] * n, [0.0] * n, [0.0] * n

    def wanted(t, y):
        qd, vd, _ = move(t)
        pose = Pose(y[:3], y[3:])
        return pose, kp * (qd - y[:3]) + kd * (vd - y[3:]) + pose.gravity

    def shaped(t, y):
        pose, tau = wanted(t, y)
        for j in range(n):
            if mode[j]:
                tau[j] = start[j] + mode[j] * most[j] * (t - since[j])
        return pose, tau

    def f(t, y):
        pose, tau = shaped(t, y)
        return np.concatenate([y[3:], acceleration(pose, np.clip(tau, -limit, limit))])

    def drift(t, y):
        """dτ/dt of what is wanted, with the derivative of gravity by central differences of order four."""
        qd, vd, ad = move(t)
        a, h = f(t, y)[3:], 1e-3
        g = [Pose(y[:3] + k * h * y[3:], y[3:]).gravity for k in (-2, -1, 1, 2)]
        return kp * (vd - y[3:]) + kd * (ad - a) + (g[0] - 8 * g[1] + 8 * g[2] - g[3]) / (12 * h)

    def guards(t, y):
        _, tau = wanted(t, y)
        slope, g = drift(t, y), []
        for j in range(n):
            if mode[j]:
                g.append((mode[j] * (tau[j] - shaped(t, y)[1][j]), j, 0.0))
            else:
                g += [(most[j] - slope[j], j, 1.0), (most[j] + slope[j], j, -1.0)]
        # Kinks of the bound.
        return g + [(limit[j] - abs(shaped(t, y)[1][j]), j, None) for j in range(n)]

    first, slope = shaped(0.0, y)[1], drift(0.0, y)
    for j in range(n):
        if abs(slope[j]) > most[j]:
            mode[j], start[j] = float(np.sign(slope[j])), first[j]
    t, out, taus, modes = 0.0, {0.0: y}, {0.0: np.clip(first, -limit, limit)}, [f"{j + 1}:goes" for j in range(n) if mode[j]]
    while t < times[-1]:
        stop = min(x for x in [*[x for x in times if x > t + 1e-13], DURATION if t < DURATION - 1e-13 else 1e9])
        events = []
        for k, (_, _, what) in enumerate(guards(t, y)):
            event = lambda t, y, k=k: guards(t, y)[k][0]
            event.terminal, event.direction = True, 0 if what is None else -1
            events.append(event)
        run = solve_ivp(f, (t, stop), y, events=events, **OPTIONS)
        before, t, y = t, run.t[-1], run.y[:, -1]
        if run.status == 1:
            k = next(k for k, hit in enumerate(run.t_events) if len(hit))
            _, j, what = guards(t, y)[k]
            if what is None:
                modes.append(f"{j + 1}:bound")
            else:
                now = shaped(t, y)[1][j]
                slope = drift(t, y)[j]
                if what == 0.0:
                    what = float(np.sign(slope)) if abs(slope) > most[j] else 0.0
                mode[j], since[j], start[j] = what, t, now
                modes.append(f"{j + 1}:{'follows' if what == 0 else 'goes'}")
        if any(abs(t - x) < 1e-13 for x in times):
            x = next(x for x in times if abs(t - x) < 1e-13)
            out[x], taus[x] = y.copy(), np.clip(shaped(t, y)[1], -limit, limit)
    print(f"# {name}: joint by joint {' '.join(modes)}")
    rows(name, times, [out[x][:3] for x in times], [out[x][3:] for x in times], [taus[x] for x in times])


def main():
    print("# case,t,q1,q2,q3,v1,v2,v3,tau1,tau2,tau3 (SI)")
    times = [round(0.1 * k, 10) for k in range(0, 16)]
    kp, kd = np.array([200.0, 300.0, 120.0]), np.array([20.0, 30.0, 8.0])

    def pd(t, pose):
        qd, vd, _ = move(t)
        return kp * (qd - pose.q) + kd * (vd - pose.v) + pose.gravity

    smooth("pd-gravity", pd, times)

    def computed(t, pose):
        qd, vd, ad = move(t)
        return pose.mass @ (ad + 15.0 * (vd - pose.v) + 80.0 * (qd - pose.q)) + pose.bias + pose.gravity

    smooth("computed-torque", computed, times)

    def impedance(t, pose):
        qd, vd, _ = move(t)
        wanted = Pose(qd, vd)
        (point, _), (target, of_target) = pose.gripper(), wanted.gripper()
        jacobian = pose.gripper()[1]
        force = 900.0 * (target - point) + 60.0 * (of_target @ vd - jacobian @ pose.v)
        return jacobian.T @ force + pose.gravity

    smooth("impedance", impedance, times)

    ki, limit = np.array([80.0, 150.0, 60.0]), np.array([12.0, 24.0, 9.0])
    pid_in_modes("pid-limits", kp, np.array([400.0, 2500.0, 300.0]), kd, np.array([6.0, 26.0, 7.0]), times)

    pd_with_rates("pd-rate-limits", kp, kd, np.array([60.0, 150.0, 30.0]), np.array([9.0, 26.0, 8.0]), times)

    def sampled(t, pose, z):
        tau = computed(t, pose)
        return np.clip(tau, -limit * 2, limit * 2), np.zeros(3)

    held("sampled-computed-torque", sampled, 0.005, 0, times)
    held("delayed-computed-torque", sampled, 0.005, 2, times)

    def sampled_pid(t, pose, z):
        qd, vd, _ = move(t)
        tau = kp * (qd - pose.q) + kd * (vd - pose.v) + ki * z
        return np.clip(tau, -limit, limit), np.where(tau > limit, 1.0, np.where(tau < -limit, -1.0, 0.0))

    held("sampled-pid-limits", sampled_pid, 0.01, 0, times)


main()
