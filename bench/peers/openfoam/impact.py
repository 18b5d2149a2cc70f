#!/usr/bin/env python3
"""What air and the wall's layer do to the pressure on a wall: interFoam runs Buchner's dam break with air and with air
a thousand times lighter, between walls that hold the water and walls that let it glide.

    bench/peers/openfoam/impact.py [--until T] CELLS [CASE...]      # cells to the column's height; all cases without

One core, 20 cells: 4 min; 40 cells with air until T = 4: 3 min. Each run's series at the wall goes to
out/bench/openfoam_impact/: T, pressure and run-up as tests/verification/dam_impact.hpp has them.
out/bench/openfoam_impact.csv is the table of all series there; bench/peers/openfoam/impact_measured.csv is such a
table, kept.
"""

import argparse
import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import cases  # noqa: E402
import logs  # noqa: E402
import runs  # noqa: E402
from common import Failed, root, work  # noqa: E402

height, length, roof, gravity = 0.6, 5.366 * 0.6, 4, 9.81  # H [m], the tank [m], its height [H], [m/s2]
sensor, last = 0.2, 7.0  # [H], T = t sqrt(g/H)
fluids = {  # density of the air [kg/m3], what walls do
    "air_no_slip": (1, "noSlip"),
    "air_slip": (1, "slip"),
    "light_air_no_slip": (1e-3, "noSlip"),
    "light_air_slip": (1e-3, "slip"),
}


def beside(n):
    """Columns of cells beside the wall in which its water is looked for."""
    return max(n // 20, 1)


def files(n, until, density, wall):
    across, up = round(length * n / height), roof * n
    h = height / n
    found = cases.inter_dam_break((length, roof * height, h), (across, up, 1), (2 * height, height), 1e-4,
                                  until / math.sqrt(gravity / height), 10, adjust=0.5, flat=True)
    places = " ".join(f"({length - (i + 0.5) * length / across:.9g} {(k + 0.5) * h:.9g} {0.5 * h:.9g})"
                      for i in range(beside(n)) for k in range(up))
    found["system/controlDict"] += ("functions {wall {type probes; libs (\"libsampling.so\"); fields (p alpha.water); "
                                    f"writeControl timeStep; writeInterval 1; probeLocations ({places});}}}}\n")
    found["constant/transportProperties"] = cases.foam(
        "dictionary", "transportProperties",
        "phases (water air); water {transportModel Newtonian; nu 1e-6; rho 1000;}\n"
        f"air {{transportModel Newtonian; nu 1.48e-5; rho {density:g};}} sigma 0;")
    found["0/U"] = found["0/U"].replace("walls {type noSlip;}", f"walls {{type {wall};}}")
    return found


def probes(path):
    """Time [s] and the values of all probes."""
    return [[float(x) for x in line.split()] for line in path.read_text().splitlines() if not line.startswith("#")]


def series(folder, n):
    """T, P, run-up [H]: pressure between the cells beside the sensor; the water on the wall ends, from the floor up,
    where a twentieth of H beside the wall is less than half full for the first time."""
    place, rows = sensor * n - 0.5, roof * n
    below, share = int(place), place - int(place)
    found = []
    for p, f in zip(probes(folder / "postProcessing/wall/0/p"), probes(folder / "postProcessing/wall/0/alpha.water")):
        filled = [sum(f[1 + k::rows]) / beside(n) for k in range(rows)]
        wet = next((k for k in range(rows) if filled[k] < 0.5), rows)
        found.append((p[0] * math.sqrt(gravity / height),
                      ((1 - share) * p[1 + below] + share * p[2 + below]) / (1000 * gravity * height), wet / n))
    return found


def mean(points, start, stop):
    """Of the pressure, linear between the points."""
    total = 0
    for (a, p, *_), (b, q, *_) in zip(points, points[1:]):
        low, high = max(a, start), min(b, stop)
        if high > low:
            at = [p + (q - p) * (t - a) / (b - a) for t in (low, high)]
            total += 0.5 * (at[0] + at[1]) * (high - low)
    return total / (stop - start)


def peak(points, start, stop, window):
    """Largest mean over a while, and the middle of that while."""
    count = round((stop - start - window) / 0.01)
    return max((mean(points, t, t + window), t + 0.5 * window) for t in (start + 0.01 * k for k in range(count + 1)))


def measures(points):
    """As tests/verification/long_dam_impact.cpp takes them."""
    first, end = peak(points, 2, 3.5, 0.05), points[-1][0]
    second = peak(points, 5, last, 0.1) if end > 0.99 * last else ("", "")
    return {"arrival": next((t for t, p, *_ in points if p >= 0.3), ""), "first_peak": first[0],
            "plateau": mean(points, 3.5, 5) if end > 5 else "", "second_peak": second[0], "second_peak_at": second[1],
            "run_up": max(p[2] for p in points) if len(points[0]) > 2 and end > 5 else ""}


def shown(values):
    return {k: f"{v:.3f}" if isinstance(v, float) else v for k, v in values.items()}


def read(path):
    """The steps and the seconds that a run took, and its series."""
    lines = path.read_text().splitlines()
    return lines[0].split()[1:], sorted(tuple(map(float, line.split(","))) for line in lines[2:])


def run(n, name, until, kept):
    folder, log, _ = runs.solve(f"impact_{n}_{name}", files(n, until, *fluids[name]), "interFoam", ["setFields"])
    steps = logs.steps(log)
    (kept / f"{name}-{n}.csv").write_text(f"# {len(steps)} {steps[-1]['seconds']:.0f}\nT,P,run_up\n" +
                                          "".join("%.5f,%.5f,%.4f\n" % p for p in series(folder, n)))


def table(kept):
    measured = read(root / "tests/verification/data/flu08_dambreak_buchner2002_pressure.csv")[1]
    rows = [{"case": "measured", "cells": "", "steps": "", "cpu_s": "", **shown(measures(measured))}]
    for path in sorted(kept.glob("*.csv")):
        name, n = path.stem.split("-")
        (steps, seconds), points = read(path)
        rows.append({"case": name, "cells": n, "steps": steps, "cpu_s": seconds, **shown(measures(points))})
    return rows


if __name__ == "__main__":
    parser = argparse.ArgumentParser(prog="bench/peers/openfoam/impact.py")
    parser.add_argument("cells", type=int)
    parser.add_argument("cases", nargs="*", type=str, help="of " + ", ".join(fluids))
    parser.add_argument("--until", type=float, default=last, help="T = t sqrt(g/H) (%(default)s)")
    options = parser.parse_args()
    if not set(options.cases) <= set(fluids):
        parser.error(f"there is no such case; there are {', '.join(fluids)}")
    kept = root / "out" / "bench" / "openfoam_impact"
    for folder in (work, kept):
        folder.mkdir(parents=True, exist_ok=True)
    for case in options.cases or fluids:
        try:
            run(options.cells, case, options.until, kept)
        except Failed as problem:
            print(f"{case}: {problem}", flush=True)
    rows = table(kept)
    for row in rows:
        print(*row.values())
    runs.save(kept.with_suffix(".csv"), rows, ": made by bench/peers/openfoam/impact.py")
