#!/usr/bin/env python3
"""How exact OpenFOAM is and how long it takes: cavity, Taylor-Green vortices, dam break, each on three grids.

    bench/peers/openfoam/accuracy.py [CASE...]      # of cavity, taylor_green, dam_break; about 15 min in all

One core. Writes out/bench/openfoam_accuracy.csv; bench/peers/openfoam_measured.csv is such a file, kept.
"""

import csv
import math
import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import logs  # noqa: E402
import runs  # noqa: E402
import water_errors  # noqa: E402
from common import root, work  # noqa: E402

data = root / "tests" / "verification" / "data"


def table(name):
    lines = [line for line in (data / name).read_text().splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


def rows_of(case, run, **errors):
    """Lines of the table, one for each error; cpu_s is what the solver says of itself."""
    steps, divergences = run.steps, [s["sum_local"] for s in run.steps if s["sum_local"] is not None]
    found = {"case": case, "cells": run.cells, "steps": len(steps), "dt_s": f"{run.dt:.6g}",
             "cpu_s": f"{run.seconds:.2f}", "wall_s": f"{run.wall:.2f}",
             "ns_per_cell_step": f"{1e9 * run.seconds / run.cells / len(steps):.0f}",
             "divergence_dt_mean": f"{sum(divergences) / len(divergences):.3g}",
             "pressure_cycles_per_step": f"{sum(s['pressure_cycles'] for s in steps) / len(steps):.1f}"}
    print(found, errors, flush=True)
    return [{**found, "error": name, "value": f"{value:.4g}"} for name, value in errors.items()]


def cavity():
    found = []
    for n in (32, 64, 128):
        run = runs.cavity(n)

        def off_ghia(name, file, place):
            return max(abs(water_errors.cubic(run.data["at"], run.data[name], float(r[place])) -
                           float(r[f"{name}_Re1000"])) for r in table(file))
        off = water_errors.extrema_off_spectral(run.data)
        found.extend(rows_of("cavity_2d_Re1000", run,
                             largest_u_off_ghia=off_ghia("u", "flu01_ghia1982_u_vertical_centreline.csv", "y"),
                             largest_v_off_ghia=off_ghia("v", "flu02_ghia1982_v_horizontal_centreline.csv", "x"),
                             **{f"{name}_off_spectral": value for name, value in off.items()}))
    return found


def taylor_green():
    found = []
    for n in (32, 64, 128):
        run = runs.taylor_green(n)
        energy = sum(x * x for name in ("u", "v") for x in run.data[name]) / n**2
        exact = 0.5 * math.exp(-4 * water_errors.viscosity * water_errors.end)
        found.extend(rows_of("taylor_green_2d", run, velocity_rms_relative=water_errors.taylor_green(run.data),
                             energy_relative=energy / exact - 1))
    return found


def interpolated(points, x):
    for (x0, y0), (x1, y1) in zip(points, points[1:]):
        if x0 <= x <= x1:
            return y0 + (y1 - y0) * (x - x0) / (x1 - x0)
    return None


def dam_break():
    """The front Z = x/a against T = t sqrt(2g/a), both made to pass Z = 1.44 at once."""
    found = []
    for n in (8, 16, 32):
        run = runs.dam_break(n)
        path = [(t * math.sqrt(2 * 9.81 / runs.width), z) for t, z in water_errors.front(run.data)]
        start = interpolated([(z, t) for t, z in path], 1.44)
        errors = {}
        for series in ("MM_n2eq2_a1.125in_pysph", "MM_n2eq2_a2.25in_pysph"):
            measured = [(float(r["T"]), float(r["Z"])) for r in
                        table("flu06_dambreak_front_martin_moyce.csv") if r["series"] == series]
            shift = start - interpolated([(z, t) for t, z in measured], 1.44)
            off = [z / m - 1 for t, m in measured if m > 1.44 and (z := interpolated(path, t + shift)) is not None]
            errors["Z_largest_relative_" + ("1.125in" if "1.125" in series else "2.25in")] = max(off, key=abs)
        volumes = logs.water_volumes(run.log)
        found.extend(rows_of("dam_break_2d_martin_moyce", run, **errors, T_at_start=start,
                             volume_lost_relative=1 - volumes[-1] / volumes[0]))
    return found


if __name__ == "__main__":
    known = {"cavity": cavity, "taylor_green": taylor_green, "dam_break": dam_break}
    chosen = sys.argv[1:] or list(known)
    if not set(chosen) <= set(known):
        sys.exit(f"there is no such case; there are {', '.join(known)}")
    work.mkdir(parents=True, exist_ok=True)
    rows = [line for name in chosen for line in known[name]()]
    runs.save(root / "out" / "bench" / "openfoam_accuracy.csv", rows, f", load {os.getloadavg()[0]:.1f}")
