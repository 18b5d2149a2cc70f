#!/usr/bin/env python3
"""Water: time to the same error on the same flows with Abrade and OpenFOAM, in turn; cell-steps a second beside it.

Run by bench/peers/run, which installs and builds what this needs.
"""

import json
import os
import shutil
import sys

from common import Failed, begin, call, pinned, root, speeds, work, write
import water_race

sys.path.insert(0, str(root / "bench" / "peers" / "openfoam"))
import cases as foam  # noqa: E402
import logs as foam_logs  # noqa: E402

program = root / "build" / "release" / "bench" / "bench_peers_water"
unit = "cell-steps/s"
environment = {"WM_PROJECT_DIR": "/usr/share/openfoam"}

# Of OpenFOAM: a folder's name, its solver, steps before the timed ones and timed steps. Of ours: the same
# steps, from the beginning again and again, and what is counted.
cavity = {"scene": "of_cavity", "openfoam": ("icoFoam", 10, 20), "abrade": ("cavity_cells", 10, 20, 20, "box")}
dam_break = {"scene": "of_dam_break", "openfoam": ("interFoam", 10, 20)}
counted = {
    "cavity_cells": cavity,
    "dam_break_cells": {**dam_break, "abrade": ("dam_break_cells", 10, 20, 20, "wet")},
    "dam_break_box": {**dam_break, "abrade": ("dam_break_cells", 10, 20, 20, "box")},
}
peers = {"openfoam": "icoFoam"}  # Debian package: its program


def make_case(scene):
    """Cavity: 64^3, Re 1000, Courant number 0.32. Dam break: 80 x 40 x 80, steps of 1 ms."""
    steps = 30
    files = {
        "of_cavity": lambda: foam.ico_cavity(64, 1e-3, 0.005, steps * 0.005),
        "of_dam_break": lambda: foam.inter_dam_break((0.584, 0.292, 0.584), (80, 40, 80), (0.1461, 0.292), 0.001,
                                                     steps * 0.001, steps * 0.001),
    }[scene]()
    shutil.rmtree(work / scene, ignore_errors=True)
    foam.write(work / scene, files)
    call(["blockMesh", "-case", scene], f"{scene}_blockMesh", environment)
    if scene == "of_dam_break":
        call(["setFields", "-case", scene], f"{scene}_setFields", environment)
    call(["decomposePar", "-case", scene], f"{scene}_decomposePar", environment)


def run_openfoam(case, threads):
    solver, warm, timed = counted[case]["openfoam"]
    command = [*pinned(threads), solver, "-case", counted[case]["scene"]]
    if threads > 1:
        as_root = ["--allow-run-as-root"] if os.geteuid() == 0 else []
        command = ["mpirun", *as_root, "--oversubscribe", "--bind-to", "core", "-np", str(threads), *command,
                   "-parallel"]
    text = call(command, f"{case}_openfoam", environment)
    steps = foam_logs.steps(text)
    if len(steps) != warm + timed:
        raise Failed(f"took {len(steps)} steps instead of {warm + timed}")
    seconds = steps[-1]["seconds"] - steps[warm - 1]["seconds"]
    cells = 64**3 if case == "cavity_cells" else 80 * 40 * 80
    divergence = sum(step["sum_local"] for step in steps[warm:]) / timed
    return cells * timed / seconds, f"{divergence:.0e}", {}


def run_abrade(case, threads):
    scene, warm, timed, rounds, of = counted[case]["abrade"]
    text = call([*pinned(threads), program, "--case", scene, "--warm", str(warm), "--steps", str(timed), "--rounds",
                 str(rounds), "--threads", str(threads)], f"{case}_abrade")
    result = json.loads(text.splitlines()[-1])
    return result[f"{of}_cell_steps_per_s"], f"{result['divergence_dt_mean']:.0e}", result


def run_code(code, case, threads):
    return run_abrade(case, threads) if code == "abrade" else run_openfoam(case, threads)


def main():
    options, usable = begin("water", __doc__.splitlines()[0], [*water_race.cases, *counted], peers)
    raced = [case for case in options.cases if case in water_race.cases]
    if raced and options.threads > 1:
        print(f"{', '.join(raced)}: left out, they are run on one core")
        raced = []
    results, failed = {"time_to_error": {}, "cell_steps_beside_it": {}}, False
    for case in raced:
        try:
            results["time_to_error"][case] = water_race.race(case, program, options.repeats, bool(usable))
        except Failed as problem:
            print(f"{case} failed: {problem}")
            failed = True
    water_race.table(results["time_to_error"])
    heading = f"{unit}, medians; in brackets the mean of |div u| dt that the steps leave"
    rows, failures = speeds(unit, heading, counted, peers, options, usable, make_case, run_code)
    results["cell_steps_beside_it"] = rows
    write("water", options, results)
    return 1 if failed or any("abrade" in f for f in failures.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
