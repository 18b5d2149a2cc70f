"""The flows on which OpenFOAM is measured, each run to its end on one core.

Each function takes a number of cells and gives a Run, whose data bench/peers/water_errors.py knows.
"""

import csv
import datetime
import shutil
import time
from dataclasses import dataclass

import bump as channel
import cases
import logs
from common import call, pinned, processor, root, version_of, work

environment = {"WM_PROJECT_DIR": "/usr/share/openfoam"}
width = 0.05715  # of the column that collapses [m]


@dataclass
class Run:
    cells: int
    steps: list  # of logs.steps
    dt: float  # [s], the mean
    wall: float  # [s]
    data: dict
    log: str

    @property
    def seconds(self):
        """Of the processor, as the solver says."""
        return self.steps[-1]["seconds"]


def solve(name, files, solver, before=()):
    """The folder, what the solver printed, and the seconds of wall clock that it took."""
    folder = work / "openfoam" / name
    shutil.rmtree(folder, ignore_errors=True)
    cases.write(folder, files)
    meshed = ["blockMesh"] if "system/blockMeshDict" in files else []
    for program in (*meshed, *before):
        call([program, "-case", folder], f"openfoam_{name}_{program}", environment)
    start = time.monotonic()
    log = call(["nice", "-n", "5", *pinned(1), solver, "-case", folder], f"openfoam_{name}", environment)
    return folder, log, time.monotonic() - start


def save(out, rows, about=""):
    """A table, below a line that says where its numbers come from; `rows`: dictionaries."""
    out.parent.mkdir(parents=True, exist_ok=True)
    with open(out, "w", newline="") as file:
        file.write(f"# OpenFOAM {version_of('openfoam', 'icoFoam')}, Debian's build, one core of {processor()}, "
                   f"{datetime.date.today()}{about}\n")
        writer = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    print(f"-> {out.relative_to(root)}")


def times(folder):
    return sorted((p for p in folder.iterdir() if p.name.replace(".", "").isdigit()), key=lambda p: float(p.name))


def cavity(n):
    """The lid-driven cavity at Re 1000 to 40 s, n^2 cells, in two dimensions."""
    dt = {32: 0.02, 64: 0.01, 128: 0.006}[n]
    folder, log, wall = solve(f"cavity_{n}", cases.ico_cavity(n, 1e-3, dt, 40, flat=True), "icoFoam")
    velocity = logs.values(times(folder)[-1] / "U")
    half = n // 2
    u = [0.5 * (velocity[j * n + half - 1][0] + velocity[j * n + half][0]) for j in range(n)]
    v = [0.5 * (velocity[(half - 1) * n + i][1] + velocity[half * n + i][1]) for i in range(n)]
    data = {"at": [0, *((i + 0.5) / n for i in range(n)), 1], "u": [0, *u, 1], "v": [0, *v, 0]}
    return Run(n * n, logs.steps(log), dt, wall, data, log)


def taylor_green(n):
    """Taylor and Green's vortices to 10 s at a Courant number of 0.4, n^2 cells."""
    dt = 10.0 / (125 * n / 32)
    folder, log, wall = solve(f"taylor_green_{n}", cases.ico_taylor_green(n, 0.01, dt, 10.0), "icoFoam")
    velocity = logs.values(times(folder)[-1] / "U")
    data = {"u": [u for u, _, _ in velocity], "v": [v for _, v, _ in velocity], "u_at": (0.5, 0.5), "v_at": (0.5, 0.5)}
    return Run(n * n, logs.steps(log), dt, wall, data, log)


def dam_break(n):
    """The column of Martin and Moyce, n cells wide, to 0.24 s in a box of 8 by 3 widths."""
    a, end, across, upwards = width, 0.24, 8 * n, 3 * n
    files = cases.inter_dam_break((8 * a, 3 * a, a / n), (across, upwards, 1), (a, 2 * a), 1.6e-3 / n, end, 0.01,
                                  adjust=0.5, flat=True)
    folder, log, wall = solve(f"dam_break_{n}", files, "interFoam", ["setFields"])
    data = {"time": [float(p.name) for p in times(folder)],
            "floor": [logs.values(p / "alpha.water")[:across] for p in times(folder)]}
    steps = logs.steps(log)
    return Run(across * upwards, steps, end / len(steps), wall, data, log)


def bump(n):
    """The channel over a bump to 4 s, n cells along."""
    dx = (channel.ends[1] - channel.ends[0]) / n
    folder, log, wall = solve(f"bump_{n}", channel.case(dx), "interFoam")
    grid = channel.Channel(dx)
    x, level = grid.levels(logs.values(times(folder)[-1] / "alpha.water"))
    steps = logs.steps(log)
    return Run(len(grid.cells), steps, channel.end / len(steps), wall, {"x": x, "level": level}, log)


by_name = {"cavity": cavity, "taylor_green": taylor_green, "dam_break": dam_break, "bump": bump}
