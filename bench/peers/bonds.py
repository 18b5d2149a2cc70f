#!/usr/bin/env python3
"""Bonds: a block of bonded spheres at rest with Abrade, ESyS-Particle and YADE, in turn.

Run by bench/peers/run, which installs and builds what this needs.
"""

import json
import os
import re
import sys

from common import Failed, call, decks, last_line, pinned, root, run_set, work
from grains import make_bed

program = root / "build" / "release" / "bench" / "bench_peers_bonds"
unit = "bond-steps/s"
gap = 1.05  # pairs nearer than that many diameters are bonded

# What each runs: its law or deck, steps before the timed ones, timed steps. Slower codes get fewer.
peers_of_block = {"esys-particle": ("block.py", 20, 100), "yade": ("block.py", 30, 60)}
cases = {
    "bonded_block": {"scene": "block.geo", "abrade": ("parallel", 100, 300), **peers_of_block},
    "bonded_block_springs": {"scene": "block.geo", "abrade": ("mohr_coulomb", 100, 300), **peers_of_block},
}
peers = {"esys-particle": "esysparticle", "yade": "yade"}  # Debian package: its program


def spheres():
    return [list(map(float, line.split())) for line in (work / "bed.xyz").read_text().splitlines()]


def make_block(scene):
    """The settled bed of the grains, cut out of its periods, with its bonds: a geometry of ESyS-Particle."""
    make_bed()
    rows, reach = spheres(), gap * 0.02
    order, bonds = sorted(range(len(rows)), key=lambda n: rows[n][0]), []
    for a, i in enumerate(order):
        for j in order[a + 1:]:
            if rows[j][0] - rows[i][0] > reach:
                break
            if sum((p - q) ** 2 for p, q in zip(rows[i], rows[j])) <= reach * reach:
                bonds.append((min(i, j), max(i, j)))
    lines = ["LSMGeometry 1.2", "BoundingBox -0.2 -0.2 -0.2 0.8 0.8 1.0", "PeriodicBoundaries 0 0 0", "Dimension 3D",
             "BeginParticles", "Simple", str(len(rows))]
    lines += [f"{x:.9g} {y:.9g} {z:.9g} 0.01 {n} 1" for n, (x, y, z) in enumerate(rows)]
    lines += ["EndParticles", "BeginConnect", str(len(bonds)), *(f"{i} {j} 0" for i, j in bonds), "EndConnect"]
    (work / scene).write_text("\n".join(lines) + "\n")


def count_bonds():
    text = (work / "block.geo").read_text()
    return int(text[text.index("BeginConnect"):].split()[1])


def run_abrade(case, threads):
    law, warm, steps = cases[case]["abrade"]
    text = call([*pinned(threads), program, "--law", law, "--scene", "bed.xyz", "--warm", str(warm), "--steps",
                 str(steps), "--threads", str(threads)], f"{case}_abrade")
    result = json.loads(text.splitlines()[-1])
    if abs(result["ledger_residual_relative"]) > 1e-6:
        raise Failed(f"the energy ledger does not close: {result['ledger_residual_relative']:.1e}")
    return result["bond_steps_per_s"], round(result["bonds"]), result


def run_peer(peer, case, threads):
    deck, warm, steps = cases[case][peer]
    if peer == "yade":
        text = call([*pinned(threads), peers[peer], f"-j{threads}", "-n", "-x", decks / "yade" / deck],
                    f"{case}_{peer}", {"WARM": str(warm), "STEPS": str(steps), "SCENE": "bed.xyz",
                                       "OMP_NUM_THREADS": str(threads)})
    else:  # one process more than workers: it waits for them
        as_root = ["--allow-run-as-root"] if os.geteuid() == 0 else []
        text = call(["mpirun", *as_root, "--oversubscribe", "--bind-to", "none", "-np", str(threads + 1), peers[peer],
                     decks / "esys" / deck, str(threads), str(warm), str(steps), "block.geo"], f"{case}_{peer}",
                    {"OMPI_MCA_mpi_yield_when_idle": "1"})
    timed = re.search(r"^timed (\d+) steps (\S+) s(?: (\d+) bonds)?", text, re.MULTILINE)
    if not timed:
        raise Failed(f"printed no time: {last_line(text)}")
    bonds = int(timed[3] or count_bonds())
    return bonds * int(timed[1]) / float(timed[2]), bonds, {}


def run_code(code, case, threads):
    return run_abrade(case, threads) if code == "abrade" else run_peer(code, case, threads)


if __name__ == "__main__":
    sys.exit(run_set("bonds", __doc__.splitlines()[0], unit, f"{unit}, medians; in brackets bonds", cases, peers,
                     make_block, run_code))
