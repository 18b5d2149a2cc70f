"""Time to the same error: whole runs of a flow with both codes, on grid after grid, in turn."""

import json
import math
import statistics
import sys
from datetime import date

import water_errors
from common import call, pinned, root

sys.path.insert(0, str(root / "bench" / "peers" / "openfoam"))
import runs as foam  # noqa: E402

kept = root / "bench" / "peers" / "openfoam_limits.csv"
schemes = ("Koren", "Central")
in_float = tuple(f"{scheme} in float" for scheme in schemes)
heights = tuple(f"{scheme}, height" for scheme in schemes)


def every(variants, *courants):
    return [(variant, courant) for variant in variants for courant in courants]


# Cells of OpenFOAM's grids and of ours, our variants with their Courant numbers, how many times less time is wanted.
# Where errors are taken off a limit: the grid of it, the same for both codes, and a finer one of ours, off which our
# limit itself is measured.
cases = {
    "cavity": {"openfoam": (32, 64, 128), "abrade": (32, 64, 96, 128), "wanted": 50, "solver": "icoFoam",
               "variants": every(schemes + in_float, 0.5, 0.9)},
    "taylor_green": {"openfoam": (32, 64, 128), "abrade": (16, 32, 64, 128), "wanted": 500, "solver": "icoFoam",
                     "variants": every(schemes + in_float, 0.5, 0.9)},
    "dam_break": {"openfoam": (8, 16, 32), "abrade": (8, 16, 32), "limit": 64, "finer": 128, "wanted": 60,
                  "solver": "interFoam", "variants": every(schemes, 0.5, 0.9)},
    "bump": {"openfoam": (30, 60, 120), "abrade": (30, 60, 120), "limit": 240, "finer": 480, "wanted": 100,
             "solver": "interFoam", "variants": every(schemes, 0.5) + every(heights, 0.5, 0.8)},
}
short = 5  # runs below are repeated [s]


def run_abrade(program, case, cells, variant="Koren", courant=0.5):
    text = call(["nice", "-n", "5", *pinned(1), program, "--case", case, "--cells", str(cells), "--variant", variant,
                 "--courant", str(courant)], f"{case}_abrade")
    return json.loads(text.splitlines()[-1])


def median_openfoam(case, cells, repeats):
    """One run where it is long, else as many as asked for; the data are the same in all."""
    found = []
    while len(found) < repeats:
        run = foam.by_name[case](cells)
        found.append(run.seconds)
        if run.seconds > short:
            break
    return statistics.median(found), run


def seconds_to(error, points):
    """Seconds to come to an error, and whether the coarsest grid is that exact already; none: not reached.

    `points`: seconds and error by grid, coarse first. From the last grid that is less exact to the next, on
    logarithmic scales; finer grids are all as exact.
    """
    worse = [k for k, (_, off) in enumerate(points) if off > error]
    if not worse:
        return points[0][0], True
    k = worse[-1]
    if k + 1 == len(points):
        return None, False
    (t0, e0), (t1, e1) = points[k], points[k + 1]
    share = math.log(e0 / error) / math.log(e0 / e1)
    return t0 * (t1 / t0) ** share, False


def best(error, ours):
    """The variant that comes to an error first, its seconds, whether on its coarsest grid."""
    reached = [(seconds, name, coarsest) for name, points in ours.items()
               for seconds, coarsest in [seconds_to(error, [(p["seconds"], p["error"]) for p in points])]
               if seconds is not None]
    return min(reached) if reached else (None, None, False)


def upstream(case, name, data):
    """Where the level stands before the bump, beside the hydrostatic one of a stream critical on the crest."""
    level = water_errors.levels(data)[0][1]
    expected = foam.channel.hydrostatic_depth(water_errors.upstream)
    print(f"  {case} {name}: level {level:.4f} m at {water_errors.upstream:g} m, {level / expected - 1:+.1%} off the "
          f"hydrostatic {expected:.4f} m", flush=True)


def our_limit(case, program):
    about = cases[case]
    runs = [run_abrade(program, case, about[grid]) for grid in ("limit", "finer")]
    limits = [water_errors.limit_of(case, run["data"]) for run in runs]
    off = water_errors.error_of(case, runs[0]["data"], limits[1])
    apart = max(abs(a - b) for (_, a), (_, b) in zip(limits[0], water_errors.kept_limits(kept)[case]))
    print(f"  {case}: our limit on {about['limit']} cells took {runs[0]['seconds']:.1f} s, {off:.2g} off that on "
          f"{about['finer']}; at most {apart:.3g} from OpenFOAM's", flush=True)
    if case == "bump":
        for grid, run in zip(("limit", "finer"), runs):
            upstream(case, f"ours on {about[grid]}", run["data"])
    return limits[0]


def race(case, program, repeats, with_openfoam):
    about = cases[case]
    theirs, ours, limits = [], {}, {"abrade": None, "openfoam": None}
    if "limit" in about:
        limits = {"abrade": our_limit(case, program), "openfoam": water_errors.kept_limits(kept)[case]}
    grids = max(about["openfoam"], about["abrade"], key=len)
    for k in range(len(grids)):
        for variant, courant in about["variants"] if k < len(about["abrade"]) else []:
            run = run_abrade(program, case, about["abrade"][k], variant, courant)
            error = water_errors.error_of(case, run["data"], limits["abrade"])
            name = variant if courant == 0.5 else f"{variant}, Courant {courant:g}"
            ours.setdefault(name, []).append({"grid": about["abrade"][k], "cells": run["cells"],
                                              "steps": run["steps"], "seconds": run["seconds"], "error": error})
            print(f"  {case} {about['abrade'][k]} {name}: {run['seconds']:.3g} s, error {error:.3g}", flush=True)
        if with_openfoam and k < len(about["openfoam"]):
            seconds, run = median_openfoam(case, about["openfoam"][k], repeats)
            error = water_errors.error_of(case, run.data, limits["openfoam"])
            theirs.append({"grid": about["openfoam"][k], "cells": run.cells, "steps": len(run.steps),
                           "seconds": seconds, "error": error})
            print(f"  {case} {about['openfoam'][k]} {about['solver']}: {seconds:.3g} s, error {error:.3g}", flush=True)
            if case == "bump":
                upstream(case, f"{about['solver']} on {about['openfoam'][k]}", run.data)
    for point in theirs:
        seconds, name, coarsest = best(point["error"], ours)
        point.update({"ours_seconds": seconds, "ours": name, "on_our_coarsest_grid": coarsest,
                      "times": point["seconds"] / seconds if seconds else None})
    reached = theirs[-1]["times"] if theirs else None
    return {"wanted": about["wanted"], "times": reached, "met": bool(reached and reached >= about["wanted"]),
            "solver": about["solver"], "date": str(date.today()), "openfoam": theirs, "abrade": ours}


def table(results):
    if not results:
        return
    print("\ntime to the same error, seconds of the processor; the last grid of a case counts")
    print(f"{'case':<14}{'grid':>6}{'error':>10}{'OpenFOAM':>10}{'ours':>10}{'times':>8}{'wanted':>8}  ")
    for case, row in results.items():
        for k, point in enumerate(row["openfoam"]):
            last = k + 1 == len(row["openfoam"])
            ours = f"{point['ours_seconds']:.3g}" if point["times"] else "-"
            times = f"{point['times']:.3g}" if point["times"] else "-"
            verdict = f"{row['wanted']:>8}  {'met' if row['met'] else 'MISSED'}; " if last else f"{'':>8}  "
            how = point["ours"] or "no run of ours is that exact"
            coarsest = ", its coarsest grid" if point["on_our_coarsest_grid"] else ""
            print(f"{case:<14}{point['grid']:>6}{point['error']:>10.2g}{point['seconds']:>10.3g}{ours:>10}{times:>8}"
                  f"{verdict}{how}{coarsest}")
