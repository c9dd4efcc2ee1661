"""The same work in numpy, measured in one run with the benchmark executable given as argument; prints the ratios.

Filter and smoother: 18 states, 330 s at 100 Hz, the textbook's matrices. Stepwise regression: one lstsq per candidate
and step on whitened columns, as it is usually written; and a version that keeps a Gram matrix.
Needs numpy and nothing else.
"""
import json
import math
import subprocess
import sys
import time

import numpy as np


def euler(o):
    (sr, sp, sy), (cr, cp, cy) = np.sin(o), np.cos(o)
    R = np.array([[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
                  [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr], [-sp, cp * sr, cp * cr]])
    C = np.array([[1, sr * sp / cp, cr * sp / cp], [0, cr, -sr], [0, sr / cp, cr / cp]])
    return R, C


def skew(a):
    return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def transition(x, dt):
    R, C = euler(x[6:9])
    back = np.linalg.inv(C)
    F = np.eye(18)
    F[0:3, 3:6] = dt * np.eye(3)
    F[0:3, 9:12] = 0.5 * dt * dt * R
    F[3:6, 9:12] = dt * R
    turned = -R @ skew(x[9:12]) @ back
    F[0:3, 6:9] = 0.5 * dt * dt * turned
    F[3:6, 6:9] = dt * turned
    F[6:9, 12:15] = dt * C
    F[6:9, 15:18] = 0.5 * dt * dt * C
    F[12:15, 15:18] = dt * np.eye(3)
    sr, cr, tp, cp = np.sin(x[6]), np.cos(x[6]), np.tan(x[7]), np.cos(x[7])
    w = dt * x[12:15]
    across, along = sr * w[1] + cr * w[2], cr * w[1] - sr * w[2]
    F[6:9, 6:9] += [[along * tp, across / cp**2, 0], [-across, 0, 0], [along / cp, across * tp / cp, 0]]
    return F, R, C


def filter_and_smoother():
    n, dt = 33000, 0.01
    rng = np.random.default_rng(1)
    q, qw = 0.05**2, 0.05**2
    tags = np.array([[20, 0, 8], [0, 20, 8], [-9, -9, 8], [15, 15, 9.0]])
    x = np.zeros(18)
    x[2] = 3.0
    P = np.diag(np.r_[np.full(3, 4.0), np.full(3, 0.25), np.full(12, 0.04)])
    xs, Ps, xp, Pp, Fs = [], [], [], [], []
    gyro = np.zeros((6, 18))
    gyro[3:, 12:15] = np.eye(3)
    gyro[:3, 9:12] = np.eye(3)
    R6 = np.diag(np.r_[np.full(3, 0.0025), np.full(3, 2.5e-5)])
    for k in range(n):
        F, R, C = transition(x, dt)
        x = x.copy()
        a = R @ x[9:12]
        x[0:3] += dt * x[3:6] + 0.5 * dt * dt * a
        x[3:6] += dt * a
        x[6:9] += C @ (dt * x[12:15] + 0.5 * dt * dt * x[15:18])
        x[12:15] += dt * x[15:18]
        P = F @ P @ F.T
        P[9:12, 9:12] += q * dt * np.eye(3)
        P[3:6, 3:6] += q * dt**3 / 3 * np.eye(3)
        P[15:18, 15:18] += qw * dt * np.eye(3)
        P[12:15, 12:15] += qw * dt**3 / 3 * np.eye(3)
        xp.append(x), Pp.append(P), Fs.append(F)
        R, C = euler(x[6:9])
        down = R[2]
        H = gyro.copy()
        H[:3, 6:9] = -9.80665 * skew(down) @ np.linalg.inv(C)
        predicted = np.r_[x[9:12] - 9.80665 * down, x[12:15]]
        z = np.r_[[0, 0.05, -9.80665] + 0.05 * rng.standard_normal(3), [0, 0, 0.1] + 0.005 * rng.standard_normal(3)]
        yaw = 0.1 * k * dt
        noise = R6
        if k % 10 == 0:
            more = np.zeros((2, 18))
            more[0, 8] = more[1, 2] = 1
            H, noise = np.vstack([H, more]), np.diag(np.r_[np.diag(noise), 4e-4, 4e-4])
            predicted = np.r_[predicted, x[8], x[2]]
            z = np.r_[z, yaw + 0.02 * rng.standard_normal(), 3 + 0.02 * rng.standard_normal()]
        if k % 100 == 0:
            p = np.array([5 * np.sin(yaw), 5 - 5 * np.cos(yaw), 3.0])
            apart = x[0:3] - tags
            r = np.linalg.norm(apart, axis=1)
            more = np.zeros((4, 18))
            more[:, 0:3] = apart / r[:, None]
            H, noise = np.vstack([H, more]), np.diag(np.r_[np.diag(noise), np.full(4, 0.01)])
            predicted = np.r_[predicted, r]
            z = np.r_[z, np.linalg.norm(p - tags, axis=1) + 0.1 * rng.standard_normal(4)]
        S = H @ P @ H.T + noise
        K = np.linalg.solve(S, H @ P).T
        x = x + K @ (z - predicted)
        P = P - K @ S @ K.T
        P = 0.5 * (P + P.T)  # without it rounding grows until the filter diverges
        xs.append(x), Ps.append(P)
    for k in range(n - 2, -1, -1):
        C = np.linalg.solve(Pp[k + 1], Fs[k + 1] @ Ps[k]).T
        xs[k] = xs[k] + C @ (xs[k + 1] - xp[k + 1])
        Ps[k] = Ps[k] + C @ (Ps[k + 1] - Pp[k + 1]) @ C.T
    return xs


def samples():
    rng = np.random.default_rng(2)
    A, e = 0.1 * rng.standard_normal((33000, 40)), rng.standard_normal(33000)
    for k in range(1, 33000):
        A[k] += 0.99 * A[k - 1]
        e[k] += 0.9 * e[k - 1]
    return A, A[:, [0, 7, 11, 23, 31]] @ [2, -3, 1.5, 1, 2.0] + e


def stepwise(A, b, gram):
    """Forward selection at phi of the full fit; fits by lstsq, or by solving with sub-matrices of one Gram matrix."""
    phi = 0.0
    for _ in range(5):
        Aw, bw = A[1:] - phi * A[:-1], b[1:] - phi * b[:-1]
        z = b - A @ np.linalg.lstsq(Aw, bw, rcond=None)[0]
        phi = z[1:] @ z[:-1] / (z[:-1] @ z[:-1])
    Aw, bw = A[1:] - phi * A[:-1], b[1:] - phi * b[:-1]
    G, g, bb, n = Aw.T @ Aw, Aw.T @ bw, bw @ bw, len(bw)

    def sse(columns):
        if gram:
            return bb - g[columns] @ np.linalg.solve(G[np.ix_(columns, columns)], g[columns])
        x = np.linalg.lstsq(Aw[:, columns], bw, rcond=None)[0]
        r = bw - Aw[:, columns] @ x
        return r @ r

    chosen, now = [], bb
    while True:
        trials = [(sse(chosen + [j]), j) for j in range(A.shape[1]) if j not in chosen]
        best, j = min(trials)
        f = (now - best) / (best / (n - len(chosen) - 2))
        if math.erfc(math.sqrt(max(f, 0.0) / 2)) > 0.05 / A.shape[1]:  # F of one and tens of thousands
            return chosen
        chosen, now = chosen + [j], best


def bootstrap(A, b, columns, repetitions):
    Aw, bw = A[1:, columns] - 0.9 * A[:-1, columns], b[1:] - 0.9 * b[:-1]
    n, block = len(bw), 200
    rng = np.random.default_rng(3)
    starts = np.arange(0, n - block + 1, block)
    for _ in range(repetitions):
        rows = (rng.choice(starts, len(starts))[:, None] + np.arange(block)).ravel()
        np.linalg.lstsq(Aw[rows], bw[rows], rcond=None)


def clock(work):
    begin = time.perf_counter()
    work()
    return 1e3 * (time.perf_counter() - begin)


def main():
    ran = subprocess.run([sys.argv[1], "--benchmark_filter=330_s|33000|bootstrap", "--benchmark_format=json"],
                         capture_output=True, check=True, text=True)
    mine = {one["name"]: one["real_time"] for one in json.loads(ran.stdout)["benchmarks"]}
    A, b = samples()
    rows = [("filter and smoother, 18 states, 330 s at 100 Hz", "kalman_smoother_330_s", clock(filter_and_smoother)),
            ("stepwise, 33000 x 40, refitting", "stepwise_33000_x_40", clock(lambda: stepwise(A, b, False))),
            ("stepwise, 33000 x 40, numpy with a Gram matrix", "stepwise_33000_x_40", clock(lambda: stepwise(A, b, True))),
            ("1000 block bootstraps, of 20 extrapolated", "bootstrap_1000",
             50 * clock(lambda: bootstrap(A, b, [0, 7, 11, 23, 31], 20)))]
    print(f"{'':50} {'ours':>10} {'numpy':>10} {'ratio':>7}")
    for name, key, theirs in rows:
        print(f"{name:50} {mine[key]:7.1f} ms {theirs:7.0f} ms {theirs / mine[key]:7.1f}")
    print(f"{'of these: one Gram pass':50} {mine['gram_33000_x_41']:7.1f} ms")
    print(f"{'the filter alone':50} {mine['kalman_filter_330_s']:7.1f} ms")


if __name__ == "__main__":
    main()
