"""Errors of the flows that bench/peers/run water compares: one function a case, for the data of any code.

cavity: speeds u along x = 1/2 and v along y = 1/2 at places `at`, ends included. taylor_green: u and v by cell, x
first, and where in a cell they are kept. dam_break: liquid fractions `floor` of the lowest row by time. bump: the level
of each column at its middle x.
"""

import csv
import math
from pathlib import Path

# Extrema on the centre lines at Re 1000: O. Botella and R. Peyret 1998, doi:10.1016/S0045-7930(98)00002-4.
spectral = {"u_min": -0.3885698, "v_max": 0.3769447, "v_min": -0.5270771}
viscosity, end = 0.01, 10.0  # of the vortices
profile = [-0.8 + 0.025 * k for k in range(57)]  # where levels over the bump are compared [m]
upstream = -1.0  # where the level before it is read [m]
crest = 0.2  # of the bump [m]


def cubic(xs, ys, x):
    """Through the four points nearest to x."""
    k = next((i for i in range(len(xs) - 1) if x <= xs[i + 1]), len(xs) - 2)
    k = min(max(k - 1, 0), len(xs) - 4)
    total = 0
    for i in range(k, k + 4):
        weight = 1
        for j in range(k, k + 4):
            if j != i:
                weight *= (x - xs[j]) / (xs[i] - xs[j])
        total += weight * ys[i]
    return total


def extrema_off_spectral(lines):
    """Of the smallest u, the largest and the smallest v, in speeds of the lid."""
    fine = [k / 5000 for k in range(5001)]
    on_u, on_v = ([cubic(lines["at"], lines[name], x) for x in fine] for name in ("u", "v"))
    found = {"u_min": min(on_u), "v_max": max(on_v), "v_min": min(on_v)}
    return {name: found[name] - spectral[name] for name in spectral}


def cavity(lines):
    return max(map(abs, extrema_off_spectral(lines).values()))


def taylor_green(field):
    """Root mean square of the error over that of the velocity."""
    n = math.isqrt(len(field["u"]))
    h, decay = 2 * math.pi / n, math.exp(-2 * viscosity * end)
    off = exact = 0
    for name, sign in (("u", 1), ("v", -1)):
        right, up = field[f"{name}_at"]
        for c, value in enumerate(field[name]):
            x, y = (c % n + right) * h, (c // n + up) * h
            wanted = decay * (math.sin(x) * math.cos(y) if sign > 0 else -math.cos(x) * math.sin(y))
            off, exact = off + (value - wanted) ** 2, exact + wanted**2
    return math.sqrt(off / exact)


def front(run):
    """Time [s] and place Z of the front [widths of the column]: where the lowest row is half full."""
    found = []
    for time, share in zip(run["time"], run["floor"]):
        wet = max(i for i in range(len(share)) if share[i] > 0.5)
        ahead = share[wet + 1] if wet + 1 < len(share) else 0
        beyond = (share[wet] - 0.5) / (share[wet] - ahead)
        found.append((time, (wet + 0.5 + beyond) * 8 / len(share)))
    return found


def dam_break(run, limit):
    """The largest difference of the front from its limit at the same time, over that."""
    if len(run["time"]) != len(limit):
        raise ValueError(f"{len(run['time'])} fronts beside {len(limit)} of the limit")
    return max(abs(z / wanted - 1) for (_, z), (_, wanted) in zip(front(run), limit))


def levels(run):
    """x and level [m] where levels are compared, and upstream."""
    return [(x, cubic(run["x"], run["level"], x)) for x in (upstream, *profile)]


def bump(run, limit):
    """Root mean square difference of the level from its limit, over the limit's depth on the crest."""
    depth = dict((round(x, 6), z) for x, z in limit)[0.0] - crest
    off = [z - wanted for (_, z), (_, wanted) in zip(levels(run)[1:], limit[1:])]
    return math.sqrt(sum(d * d for d in off) / len(off)) / depth


def limit_of(case, data):
    """What runs of a case are compared with, from the run on the finest grid."""
    return {"dam_break": front, "bump": levels}[case](data)


def kept_limits(path):
    """The limits by case that bench/peers/openfoam/limits.py wrote."""
    found = {}
    lines = [line for line in Path(path).read_text().splitlines() if not line.startswith("#")]
    for row in csv.DictReader(lines):
        found.setdefault(row["case"], []).append((float(row["at"]), float(row["value"])))
    return found


def error_of(case, data, limit):
    return {"cavity": cavity, "taylor_green": taylor_green}[case](data) if limit is None else {
        "dam_break": dam_break, "bump": bump}[case](data, limit)
