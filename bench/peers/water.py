#!/usr/bin/env python3
"""Water: the same flows with Abrade and OpenFOAM, in turn.

Run by bench/peers/run, which installs and builds what this needs.
"""

import json
import os
import shutil
import sys

from common import Failed, call, pinned, root, run_set, work

sys.path.insert(0, str(root / "bench" / "peers" / "openfoam"))
import cases as foam  # noqa: E402
import logs as foam_logs  # noqa: E402

program = root / "build" / "release" / "bench" / "bench_peers_water"
unit = "cell-steps/s"
environment = {"WM_PROJECT_DIR": "/usr/share/openfoam"}

# Of OpenFOAM: a folder's name, its solver, steps before the timed ones and timed steps. Of ours: the same
# steps, from the beginning again and again, and what is counted.
cavity = {"scene": "of_cavity", "openfoam": ("icoFoam", 10, 20), "abrade": ("cavity", 10, 20, 20, "box")}
dam_break = {"scene": "of_dam_break", "openfoam": ("interFoam", 10, 20)}
cases = {
    "cavity": cavity,
    "dam_break": {**dam_break, "abrade": ("dam_break", 10, 20, 20, "wet")},
    "dam_break_box": {**dam_break, "abrade": ("dam_break", 10, 20, 20, "box")},
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
    solver, warm, timed = cases[case]["openfoam"]
    command = [*pinned(threads), solver, "-case", cases[case]["scene"]]
    if threads > 1:
        as_root = ["--allow-run-as-root"] if os.geteuid() == 0 else []
        command = ["mpirun", *as_root, "--oversubscribe", "--bind-to", "core", "-np", str(threads), *command,
                   "-parallel"]
    text = call(command, f"{case}_openfoam", environment)
    steps = foam_logs.steps(text)
    if len(steps) != warm + timed:
        raise Failed(f"took {len(steps)} steps instead of {warm + timed}")
    seconds = steps[-1]["seconds"] - steps[warm - 1]["seconds"]
    cells = 64**3 if case == "cavity" else 80 * 40 * 80
    divergence = sum(step["sum_local"] for step in steps[warm:]) / timed
    return cells * timed / seconds, f"{divergence:.0e}", {}


def run_abrade(case, threads):
    scene, warm, timed, rounds, counted = cases[case]["abrade"]
    text = call([*pinned(threads), program, "--case", scene, "--warm", str(warm), "--steps", str(timed), "--rounds",
                 str(rounds), "--threads", str(threads)], f"{case}_abrade")
    result = json.loads(text.splitlines()[-1])
    return result[f"{counted}_cell_steps_per_s"], f"{result['divergence_dt_mean']:.0e}", result


def run_code(code, case, threads):
    return run_abrade(case, threads) if code == "abrade" else run_openfoam(case, threads)


if __name__ == "__main__":
    sys.exit(run_set("water", __doc__.splitlines()[0], unit,
                     f"{unit}, medians; in brackets the mean of |div u| dt that the steps leave", cases, peers,
                     make_case, run_code))
