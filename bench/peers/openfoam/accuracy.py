#!/usr/bin/env python3
"""How exact OpenFOAM is and how long it takes: cavity, Taylor-Green vortices, dam break, each on three grids.

    bench/peers/openfoam/accuracy.py [CASE...]      # of cavity, taylor_green, dam_break; about 15 min in all

One core. Writes out/bench/openfoam_accuracy.csv; bench/peers/openfoam_measured.csv is such a file, kept.
"""

import csv
import datetime
import math
import os
import shutil
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import cases  # noqa: E402
import logs  # noqa: E402
from common import call, pinned, processor, root, version_of, work  # noqa: E402

data = root / "tests" / "verification" / "data"
environment = {"WM_PROJECT_DIR": "/usr/share/openfoam"}


def run(name, files, solver, before=()):
    """The folder, what the solver printed, and the seconds of wall clock that it took."""
    folder = work / "openfoam" / name
    shutil.rmtree(folder, ignore_errors=True)
    cases.write(folder, files)
    for program in (*(["blockMesh"] if "system/blockMeshDict" in files else []), *before):
        call([program, "-case", folder], f"openfoam_{name}_{program}", environment)
    start = time.monotonic()
    log = call(["nice", "-n", "5", *pinned(1), solver, "-case", folder], f"openfoam_{name}", environment)
    return folder, log, time.monotonic() - start


def last_time(folder):
    return max((p for p in folder.iterdir() if p.name.replace(".", "").isdigit()), key=lambda p: float(p.name))


def table(name):
    lines = [line for line in (data / name).read_text().splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


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


def rows_of(case, cells, steps, dt, wall, **errors):
    """Lines of the table, one for each error; cpu_s is what the solver says of itself."""
    seconds, divergences = steps[-1]["seconds"], [s["sum_local"] for s in steps if s["sum_local"] is not None]
    found = {"case": case, "cells": cells, "steps": len(steps), "dt_s": f"{dt:.6g}", "cpu_s": f"{seconds:.2f}",
             "wall_s": f"{wall:.2f}", "ns_per_cell_step": f"{1e9 * seconds / cells / len(steps):.0f}",
             "divergence_dt_mean": f"{sum(divergences) / len(divergences):.3g}",
             "pressure_cycles_per_step": f"{sum(s['pressure_cycles'] for s in steps) / len(steps):.1f}"}
    print(found, errors, flush=True)
    return [{**found, "error": name, "value": f"{value:.4g}"} for name, value in errors.items()]


# --- the cavity, Re 1000 --------------------------------------------------------------------------------------

# Extrema on the centre lines: Botella and Peyret 1998, doi:10.1016/S0045-7930(98)00002-4.
spectral = {"u_min": -0.3885698, "v_max": 0.3769447, "v_min": -0.5270771}


def cavity():
    found = []
    for n, dt in ((32, 0.02), (64, 0.01), (128, 0.006)):
        folder, log, wall = run(f"cavity_{n}", cases.ico_cavity(n, 1e-3, dt, 40, flat=True), "icoFoam")
        velocity = logs.values(last_time(folder) / "U")
        at = [0, *((i + 0.5) / n for i in range(n)), 1]
        half = n // 2
        u = [0, *(0.5 * (velocity[j * n + half - 1][0] + velocity[j * n + half][0]) for j in range(n)), 1]
        v = [0, *(0.5 * (velocity[(half - 1) * n + i][1] + velocity[half * n + i][1]) for i in range(n)), 0]
        off_u = [abs(cubic(at, u, float(r["y"])) - float(r["u_Re1000"]))
                 for r in table("flu01_ghia1982_u_vertical_centreline.csv")]
        off_v = [abs(cubic(at, v, float(r["x"])) - float(r["v_Re1000"]))
                 for r in table("flu02_ghia1982_v_horizontal_centreline.csv")]
        fine = [k / 5000 for k in range(5001)]
        on_u, on_v = [cubic(at, u, x) for x in fine], [cubic(at, v, x) for x in fine]
        ours = {"u_min": min(on_u), "v_max": max(on_v), "v_min": min(on_v)}
        found.extend(rows_of("cavity_2d_Re1000", n * n, logs.steps(log), dt, wall, largest_u_off_ghia=max(off_u),
                         largest_v_off_ghia=max(off_v),
                         **{f"{k}_off_spectral": ours[k] - spectral[k] for k in spectral}))
    return found


# --- Taylor and Green's vortices ------------------------------------------------------------------------------


def taylor_green():
    found, viscosity, end = [], 0.01, 10.0
    for n in (32, 64, 128):
        dt = 10.0 / (125 * n / 32)  # Courant number 0.4
        folder, log, wall = run(f"taylor_green_{n}", cases.ico_taylor_green(n, viscosity, dt, end), "icoFoam")
        velocity = logs.values(last_time(folder) / "U")
        square = energy = exact = 0
        for (x, y), (u, v, _) in zip(cases.centres(n, 2 * math.pi), velocity):
            p, q, _ = cases.taylor_green(x, y, viscosity, end)
            square += (u - p) ** 2 + (v - q) ** 2
            energy, exact = energy + u * u + v * v, exact + p * p + q * q
        found.extend(rows_of("taylor_green_2d", n * n, logs.steps(log), dt, wall,
                         velocity_rms_relative=math.sqrt(square / exact), energy_relative=energy / exact - 1))
    return found


# --- the dam break of Martin and Moyce ------------------------------------------------------------------------


def front(folder, n, width):
    """Where water ends on the floor, by time [m]."""
    found = []
    for step in sorted((p for p in folder.iterdir() if p.name.replace(".", "").isdigit()), key=lambda p: float(p.name)):
        share = logs.values(step / "alpha.water")[:width]
        wet = max(i for i in range(width) if share[i] > 0.5)
        ahead = share[wet + 1] if wet + 1 < width else 0
        found.append((float(step.name), (wet + 0.5 + (share[wet] - 0.5) / (share[wet] - ahead)) / n))
    return found


def interpolated(points, x):
    for (x0, y0), (x1, y1) in zip(points, points[1:]):
        if x0 <= x <= x1:
            return y0 + (y1 - y0) * (x - x0) / (x1 - x0)
    return None


def dam_break():
    """The front Z = x/a against T = t sqrt(2g/a), both made to pass Z = 1.44 at once."""
    found, a, end = [], 0.05715, 0.24
    for n in (8, 16, 32):
        across, upwards = 8 * n, 3 * n
        files = cases.inter_dam_break((8 * a, 3 * a, a / n), (across, upwards, 1), (a, 2 * a), 2e-4, end, 0.01,
                                      adjust=0.5, flat=True)
        folder, log, wall = run(f"dam_break_{n}", files, "interFoam", ["setFields"])
        path = [(t * math.sqrt(2 * 9.81 / a), z) for t, z in front(folder, n, across)]
        start = interpolated([(z, t) for t, z in path], 1.44)
        errors = {}
        for series in ("MM_n2eq2_a1.125in_pysph", "MM_n2eq2_a2.25in_pysph"):
            measured = [(float(r["T"]), float(r["Z"])) for r in
                        table("flu06_dambreak_front_martin_moyce.csv") if r["series"] == series]
            shift = start - interpolated([(z, t) for t, z in measured], 1.44)
            off = [z / m - 1 for t, m in measured if m > 1.44 and (z := interpolated(path, t + shift)) is not None]
            errors["Z_largest_relative_" + ("1.125in" if "1.125" in series else "2.25in")] = max(off, key=abs)
        volumes = logs.water_volumes(log)
        steps = logs.steps(log)
        found.extend(rows_of("dam_break_2d_martin_moyce", across * upwards, steps, end / len(steps), wall, **errors,
                         T_at_start=start, volume_lost_relative=1 - volumes[-1] / volumes[0]))
    return found


if __name__ == "__main__":
    known = {"cavity": cavity, "taylor_green": taylor_green, "dam_break": dam_break}
    chosen = sys.argv[1:] or list(known)
    if not set(chosen) <= set(known):
        sys.exit(f"there is no such case; there are {', '.join(known)}")
    work.mkdir(parents=True, exist_ok=True)
    rows = [line for name in chosen for line in known[name]()]
    out = root / "out" / "bench" / "openfoam_accuracy.csv"
    out.parent.mkdir(parents=True, exist_ok=True)
    with open(out, "w", newline="") as file:
        file.write(f"# OpenFOAM {version_of('openfoam', 'icoFoam')}, Debian's build, one core of {processor()}, "
                   f"{datetime.date.today()}, load {os.getloadavg()[0]:.1f}\n")
        writer = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    print(f"-> {out.relative_to(root)}")
