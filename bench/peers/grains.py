#!/usr/bin/env python3
"""Grains: the same scenes with Abrade, LAMMPS, LIGGGHTS and YADE, in turn.

Run by bench/peers/run, which installs and builds what this needs.
"""

import json
import os
import re
import shutil
import sys

from common import Failed, call, decks, last_line, pinned, root, run_set, work, write_rows

program = root / "build" / "release" / "bench" / "bench_peers_grains"
unit = "particle-steps/s"

# What each runs: the deck, steps before the timed ones, timed steps. Slower codes get fewer.
cases = {
    "bed_linear": {
        "scene": "bed.xyz",
        "abrade": (None, 500, 2000),
        "lammps": ("bed.in", 500, 1000),
        "liggghts": ("bed.in", 500, 1000),
        "yade": ("bed.py", 500, 200),
    },
    "bed_hertz": {
        "scene": "bed.xyz",
        "abrade": (None, 500, 2000),
        "lammps": ("bed.in", 500, 1000),
        "liggghts": ("bed.in", 500, 1000),
        "yade": ("bed.py", 500, 200),
    },
    "gas": {
        "scene": "gas.xyzv",
        "abrade": (None, 1000, 5000),
        "lammps": ("gas.in", 1000, 2000),
        "liggghts": ("gas.in", 1000, 2000),
        "yade": ("gas.py", 1000, 500),
    },
    "bed_clumps": {
        "scene": "clumps.xyz",
        "abrade": (None, 500, 3000),
        "lammps": ("clumps.in", 500, 2000),
        "liggghts": ("clumps.in", 500, 1000),
    },
}
peers = {"lammps": "lmp", "liggghts": "liggghts", "yade": "yade"}  # Debian package: its program

# The law of a deck by case; LIGGGHTS wants the coefficients as well, the same as those in the decks of LAMMPS.
law_of = {"bed_linear": "hooke", "bed_hertz": "hertz"}
liggghts_coefficients = {
    "hooke": {"kn": "1e5", "kt": "28571.43", "gn": "1883.0", "gt": "941.5"},
    "hertz": {"kn": "7.11e7", "kt": "9.14e7", "gn": "4.8e6", "gt": "2.4e6"},
}


# --- initial states --------------------------------------------------------------------------------


def rows_of_dump(path):
    """The numbers of the last state in a dump of LAMMPS."""
    text = path.read_text()
    body = text[text.rindex("ITEM: ATOMS"):].splitlines()[1:]
    return [[float(word) for word in line.split()] for line in body]


def write_lammps_data(path, title, low, high, positions, velocities=()):
    lines = [title, "", f"{len(positions)} atoms", "1 atom types", ""]
    lines += [f"{low[a]:.12g} {high[a]:.12g} {'xyz'[a]}lo {'xyz'[a]}hi" for a in range(3)]
    lines += ["", "Atoms", ""]
    lines += [f"{n} 1 0.02 2500 {x:.10g} {y:.10g} {z:.10g}" for n, (x, y, z) in enumerate(positions, 1)]
    if velocities:
        lines += ["", "Velocities", ""]
        lines += [f"{n} {u:.10g} {v:.10g} {w:.10g} 0 0 0" for n, (u, v, w) in enumerate(velocities, 1)]
    path.write_text("\n".join(lines) + "\n")


def settle(deck):
    """LAMMPS lets the grains of a bed fall and come to rest."""
    print(f"settling out/bench/peers/{deck}, once", flush=True)
    call([peers["lammps"], "-in", decks / "lammps" / f"make_{deck}.in", "-log", "none"], f"make_{deck}",
         {"OMP_NUM_THREADS": "1"})


def make_bed():
    if not (work / "bed.xyz").exists():
        settle("bed")
        side = 0.54
        rows = [[x % side % side, y % side % side, z] for _, x, y, z in rows_of_dump(work / "bed.dump")]
        write_rows(work / "bed.xyz", rows)
    rows = [list(map(float, line.split())) for line in (work / "bed.xyz").read_text().splitlines()]
    write_lammps_data(work / "bed.lmp", "settled bed", (0, 0, -0.005), (0.54, 0.54, 0.7), rows)


def make_gas():
    call([program, "--make-gas", work / "gas.xyzv"], "make_gas")
    rows = [list(map(float, line.split())) for line in (work / "gas.xyzv").read_text().splitlines()]
    side = (len(rows) * 4 / 3 * 3.141592653589793 * 1e-6 / 0.1) ** (1 / 3)
    write_lammps_data(work / "gas.lmp", "gas", (0, 0, 0), (side,) * 3, [r[:3] for r in rows], [r[3:] for r in rows])


def make_clumps():
    shutil.copy(decks / "lammps" / "clump8.mol", work)
    shutil.copy(decks / "liggghts" / "clump8.txt", work)
    if not (work / "clumps.xyz").exists() or not (work / "clumps.restart").exists():
        settle("clumps")
        rows = sorted(rows_of_dump(work / "clumps.dump"), key=lambda row: (row[1], row[0]))
        write_rows(work / "clumps.xyz", [row[2:] for row in rows])


makers = {"bed.xyz": make_bed, "gas.xyzv": make_gas, "clumps.xyz": make_clumps}

# --- one run of one code, in particle-steps per second ------------------------------------------------


def run_abrade(case, threads):
    _, warm, steps = cases[case]["abrade"]
    text = call([*pinned(threads), program, "--case", case, "--scene", cases[case]["scene"], "--warm", str(warm),
                 "--steps", str(steps), "--threads", str(threads)], f"{case}_abrade")
    result = json.loads(text.splitlines()[-1])
    if abs(result["ledger_residual_relative"]) > 1e-6:
        raise Failed(f"the energy ledger does not close: {result['ledger_residual_relative']:.1e}")
    return result["particle_steps_per_s"], result["contacts"], result


def run_lammps_kind(peer, case, threads):
    deck, warm, steps = cases[case][peer]
    variables = {"warm": str(warm), "n": str(steps)}
    if case in law_of:
        variables["law"] = law_of[case]
        if peer == "liggghts":
            variables.update(liggghts_coefficients[law_of[case]])
    start = pinned(threads)
    if threads > 1:
        as_root = ["--allow-run-as-root"] if os.geteuid() == 0 else []
        start = ["mpirun", *as_root, "--oversubscribe", "--bind-to", "core", "-np", str(threads)]
    command = [*start, peers[peer], "-in", decks / peer / deck, "-log", "none"]
    for name, value in variables.items():
        command += ["-var", name, value]
    text = call(command, f"{case}_{peer}", {"OMP_NUM_THREADS": "1"})
    loops = re.findall(r"Loop time of (\S+) on \d+ procs for (\d+) steps with (\d+) atoms", text)
    if not loops:
        raise Failed("printed no loop time")
    seconds, timed, atoms = map(float, loops[-1])
    expected = 12000 if case == "bed_clumps" else 20000
    if (timed, atoms) != (steps, expected):
        raise Failed(f"timed {timed:.0f} steps of {atoms:.0f} spheres instead of {steps} of {expected}")
    # The last line of numbers before the loop time: step, atoms, ..., contacts of an atom, seconds.
    numbers = [line.split() for line in text[:text.rindex("Loop time of")].splitlines()]
    numbers = [n for n in numbers if n and re.fullmatch(r"\d+", n[0])]
    contacts = None
    if numbers and "c_z" in (decks / peer / deck).read_text():
        contacts = round(0.5 * atoms * float(numbers[-1][-2]))
    return atoms * steps / seconds, contacts, {}


def run_yade(case, threads):
    deck, warm, steps = cases[case]["yade"]
    text = call([*pinned(threads), peers["yade"], f"-j{threads}", "-n", "-x", decks / "yade" / deck], f"{case}_yade",
                {"LAW": "mindlin" if case == "bed_hertz" else "viscel", "WARM": str(warm), "STEPS": str(steps),
                 "SCENE": cases[case]["scene"], "OMP_NUM_THREADS": str(threads)})
    timed = re.search(r"^timed (\d+) spheres (\d+) steps (\S+) s (\d+) contacts", text, re.MULTILINE)
    if not timed:
        raise Failed(f"printed no time: {last_line(text)}")
    return int(timed[1]) * int(timed[2]) / float(timed[3]), int(timed[4]), {}


def run_code(code, case, threads):
    if code == "abrade":
        return run_abrade(case, threads)
    if code == "yade":
        return run_yade(case, threads)
    return run_lammps_kind(code, case, threads)


if __name__ == "__main__":
    sys.exit(run_set("grains", __doc__.splitlines()[0], unit,
                     f"{unit}, medians; in brackets touching pairs of spheres at the end", cases, peers,
                     lambda scene: makers[scene](), run_code))
