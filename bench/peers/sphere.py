#!/usr/bin/env python3
"""Sphere: time to the same error in the drag of a fixed sphere, resolved by Abrade and penalised by OpenFOAM.

Run by bench/peers/run, which installs and builds what this needs.
"""

import argparse
import csv
import json
import math
import sys
from datetime import date

from common import Failed, call, flags_of_ours, listed, pinned, processor, root, version_of, work
from water_race import seconds_to

sys.path.insert(0, str(root / "bench" / "peers" / "openfoam"))
import logs as foam_logs  # noqa: E402
import runs as foam  # noqa: E402
import sphere as foam_sphere  # noqa: E402

program = root / "build" / "release" / "bench" / "bench_peers_sphere"
kept, errors = (root / "out" / "bench" / f"peers_sphere{what}.csv" for what in ("", "_errors"))
end = 12  # [diameters over the stream's speed]
places = (0, 0.3, 0.6)  # of the sphere's centre off a corner of cells [cell]
openfoam_step = 0.4  # of OpenFOAM, and the largest of "OpenFOAM's step" [cell over the stream's speed]
strong = 1e3  # a rate that stops the water [speed/diameter]

# C_d in infinite water (L. Schiller and A. Naumann), beside the reference in this stream.
curve = {100: 1.092, 20: 2.610}

# OpenFOAM's step [cell over the stream's speed] and the tolerance of its equations. Long steps change its drag by less
# than a tenth of its error, and no tolerance of these changes it.
settings = {"": (openfoam_step, 1e-5), " in long steps": (0.8, 1e-3)}

# What holds the water back in a cell of which the sphere covers a share [1/s]; n cells to a diameter.
rates = {
    "half-covered cells": lambda share, n, reynolds: strong if share >= 0.5 else 0.0,
    "by share": lambda share, n, reynolds: strong * share,
    "graded": lambda share, n, reynolds: min(strong, 12 * n * n / reynolds * share / max(1 - share, 1e-9)),
}
penalised = {rate + setting: (rate, setting) for rate in rates for setting in settings
             if not (setting and rate == "by share")}
ours = {
    "Courant 0.9": lambda n: ["--courant", "0.9"],
    "Courant 0.5": lambda n: ["--courant", "0.5"],
    "OpenFOAM's step": lambda n: ["--courant", "1", "--step", f"{openfoam_step / n:.12g}"],
}
columns = ("code", "variant", "reynolds", "cells", "off", "steps", "cpu_s", "drag")


def fitted():
    """C_d by Reynolds number at the same end: its limit on grids that fit the sphere, of second order, which
    openfoam/sphere_fitted.py measured."""
    lines = (root / "bench" / "peers" / "openfoam_sphere_fitted.csv").read_text().splitlines()[1:]
    found = {}
    for row in csv.DictReader(lines):
        found.setdefault(int(row["reynolds"]), []).append((int(row["cells_across_an_eighth"]), float(row["drag"])))
    limits = {}
    for reynolds, of in found.items():
        (m0, d0), (m1, d1) = sorted(of)[-2:]
        limits[reynolds] = d1 + (d1 - d0) / ((m1 / m0) ** 2 - 1)
    return limits


reference = fitted()


def run_abrade(variant, reynolds, n, off):
    text = call(["nice", "-n", "5", *pinned(1), program, "--cells", str(n), "--reynolds", str(reynolds), "--off",
                 str(off), "--end", str(end), *ours[variant](n)], "sphere_abrade")
    found = json.loads(text.splitlines()[-1])
    return found["steps"], found["seconds"], found["drag"]


def run_openfoam(variant, reynolds, n, off):
    rate, setting = penalised[variant]
    step, tolerance = settings[setting]
    files = foam_sphere.case(n, reynolds, step / n, end, off, lambda share: rates[rate](share, n, reynolds), tolerance)
    name = f"sphere_{variant.replace(' ', '_')}_{reynolds}_{n}_{off}"
    folder, log, _ = foam.solve(name, files, "pisoFoam", ["topoSet"])
    steps = foam_logs.steps(log)
    late = [drag for time, drag in foam_sphere.drags(folder) if time >= 0.75 * end]
    return len(steps), steps[-1]["seconds"], sum(late) / len(late)


def kept_rows():
    if not kept.exists():
        return {}
    lines = [line for line in kept.read_text().splitlines() if not line.startswith("#")]
    return {tuple(row[c] for c in columns[:5]): row for row in csv.DictReader(lines)}


def keep(rows):
    with open(kept, "w", newline="") as file:
        file.write(f"# Made by bench/peers/run sphere: fixed sphere of diameter 1 in a stream of speed 1. OpenFOAM "
                   f"{version_of('openfoam', 'pisoFoam')}, one core of {processor()}.\n"
                   f"# cells: to a diameter; off: of the sphere's centre from a corner of cells [cell]; drag: C_d, "
                   f"mean of the last quarter of {end}.\n")
        writer = csv.DictWriter(file, columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows(sorted(rows.values(), key=lambda r: (r["code"], r["variant"], -int(r["reynolds"]),
                                                              int(r["cells"]), r["off"])))


def race(options):
    """Runs what is not kept yet: place by place both codes, in turn."""
    rows = kept_rows()
    for reynolds in options.reynolds:
        for n in options.cells:
            for off in places:
                for code, run, variants in (("abrade", run_abrade, ours), ("openfoam", run_openfoam, penalised)):
                    for variant in variants:
                        key = (code, variant, str(reynolds), str(n), str(off))
                        if key in rows or variant not in options.variants:
                            continue
                        steps, seconds, drag = run(variant, reynolds, n, off)
                        rows[key] = dict(zip(columns, (*key, steps, f"{seconds:.4g}", f"{drag:.5f}")))
                        print(*rows[key].values(), flush=True)
                        keep(rows)
    return rows


def points(rows, reynolds):
    """By code and variant: for each grid cells, mean steps and seconds, error, mean drag over the reference.

    The error is the root mean square over the places of the drag's difference from the reference, over that.
    """
    found = {}
    for row in rows.values():
        if int(row["reynolds"]) == reynolds:
            found.setdefault((row["code"], row["variant"]), {}).setdefault(int(row["cells"]), []).append(row)
    answer = {}
    for name, grids in sorted(found.items()):
        for n, of in sorted(grids.items()):
            if len(of) < len(places):
                continue
            off = [float(row["drag"]) / reference[reynolds] - 1 for row in of]
            answer.setdefault(name, []).append({
                "cells": n, "steps": round(sum(int(row["steps"]) for row in of) / len(of)),
                "seconds": sum(float(row["cpu_s"]) for row in of) / len(of),
                "error": math.sqrt(sum(d * d for d in off) / len(off)), "mean": sum(off) / len(off)})
    return answer


def compare(found):
    """For each of OpenFOAM's points the least seconds that ours takes to its error."""
    for (code, _), theirs in found.items():
        for point in theirs if code == "openfoam" else []:
            reached = [(seconds, variant, coarsest) for (code, variant), of in found.items() if code == "abrade"
                       for seconds, coarsest in [seconds_to(point["error"], [(p["seconds"], p["error"]) for p in of])]
                       if seconds is not None]
            if reached:
                point["ours_seconds"], point["ours"], point["on_our_coarsest_grid"] = min(reached)
                point["times"] = point["seconds"] / point["ours_seconds"]


def table(found, reynolds):
    print(f"\nRe {reynolds}: C_d {reference[reynolds]:.3f} on grids that fit the sphere; in infinite water {curve[reynolds]}")
    print(f"{'':<44}{'cells':>6}{'steps':>7}{'mean':>9}{'error':>8}{'seconds':>9}{'ours':>9}{'times':>8}")
    for (code, variant), of in found.items():
        for p in of:
            beside = f"{p['ours_seconds']:>9.3g}{p['times']:>8.3g}" if "times" in p else ""
            coarsest = ", our coarsest grid" if p.get("on_our_coarsest_grid") else ""
            print(f"{code + ', ' + variant:<44}{p['cells']:>6}{p['steps']:>7}{p['mean']:>+9.1%}{p['error']:>8.1%}"
                  f"{p['seconds']:>9.3g}{beside}" + (f"  {p['ours']}{coarsest}" if beside else ""))


def keep_errors(by_reynolds):
    with open(errors, "w", newline="") as file:
        file.write(f"# Made by bench/peers/run sphere. OpenFOAM {version_of('openfoam', 'pisoFoam')}, one core of "
                   f"{processor()}, {date.today()}.\n# cells: to a diameter; seconds, mean and root mean square of the "
                   f"drag's difference from the fitted grid's, over that: of {len(places)} places.\n")
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(("code", "variant", "reynolds", "cells", "steps", "cpu_s", "mean", "error"))
        for reynolds, found in by_reynolds.items():
            for name, of in found.items():
                writer.writerows((*name, reynolds, p["cells"], p["steps"], f"{p['seconds']:.4g}", f"{p['mean']:.4f}",
                                  f"{p['error']:.4f}") for p in of)
    print(f"-> {errors.relative_to(root)}")


def numbers(text):
    return [int(word) for word in text.split(",")]


def main():
    parser = argparse.ArgumentParser(prog="bench/peers/run sphere", description=__doc__.splitlines()[0],
                                     epilog=f"Runs in {kept.relative_to(root)} are not run again.")
    parser.add_argument("--reynolds", type=numbers, default=list(reference), help="of 100,20")
    parser.add_argument("--cells", type=numbers, default=[2, 3, 4, 6], help="to a diameter (2,3,4,6)")
    parser.add_argument("--variants", type=listed([*ours, *penalised]), default=[*ours, *penalised],
                        help="of " + ",".join([*ours, *penalised]))
    options = parser.parse_args()
    if not set(options.reynolds) <= set(reference):
        parser.error("--reynolds is of " + ", ".join(map(str, reference)))
    work.mkdir(parents=True, exist_ok=True)
    kept.parent.mkdir(parents=True, exist_ok=True)
    print(processor(), "\nours:", flags_of_ours("sphere"), "\nOpenFOAM:", version_of("openfoam", "pisoFoam"))
    try:
        rows = race(options)
    except Failed as problem:
        print(f"failed: {problem}")
        return 1
    found = {reynolds: points(rows, reynolds) for reynolds in reference}
    for reynolds, of in found.items():
        compare(of)
        table(of, reynolds)
    keep_errors(found)
    return 0


if __name__ == "__main__":
    sys.exit(main())
