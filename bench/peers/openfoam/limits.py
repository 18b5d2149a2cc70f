#!/usr/bin/env python3
"""What OpenFOAM comes to on fine grids, off which bench/peers/run water takes its errors: the front of the column that
collapses on 64 cells a width, the level over the bump on 240 cells along.

    bench/peers/openfoam/limits.py [CASE...]      # of dam_break, bump; 10 min

One core. Writes out/bench/openfoam_limits.csv; bench/peers/openfoam_limits.csv is such a file, kept.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import runs  # noqa: E402
import water_errors  # noqa: E402
from common import root, work  # noqa: E402

finest = {"dam_break": 64, "bump": 240}


def rows_of(case):
    run = runs.by_name[case](finest[case])
    print(f"{case}: {run.cells} cells, {len(run.steps)} steps, {run.seconds:.0f} s", flush=True)
    return [{"case": case, "cells": finest[case], "cpu_s": f"{run.seconds:.0f}", "at": f"{at:.6g}",
             "value": f"{value:.8g}"} for at, value in water_errors.limit_of(case, run.data)]


if __name__ == "__main__":
    chosen = sys.argv[1:] or list(finest)
    if not set(chosen) <= set(finest):
        sys.exit(f"there is no such case; there are {', '.join(finest)}")
    work.mkdir(parents=True, exist_ok=True)
    rows = [row for case in chosen for row in rows_of(case)]
    runs.save(root / "out" / "bench" / "openfoam_limits.csv", rows, ": made by bench/peers/openfoam/limits.py.\n"
              "# dam_break: time [s], front Z [widths of the column]. bump: x, level [m]. cells: to a width, along.")
