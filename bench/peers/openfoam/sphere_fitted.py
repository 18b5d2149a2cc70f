#!/usr/bin/env python3
"""The drag of the sphere in the stream on a grid that is fitted to the sphere: the answer that errors are taken off.

    bench/peers/openfoam/sphere_fitted.py [CELLS...]      # across an eighth of the sphere's girth; 8 and 12 are usual

A quarter of the stream, icoFoam, second order in space and time. Writes out/bench/openfoam_sphere_fitted.csv.
"""

import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import cases  # noqa: E402
import logs  # noqa: E402
import runs  # noqa: E402
from common import root, work  # noqa: E402

radius, shell, end = 0.5, 1.5, 12  # [diameters], half a side of the box about the sphere, [diameters/speed]


class Blocks:
    """Hexahedra of blockMesh; corners are numbered as they come."""

    def __init__(self):
        self.corners, self.hexes = [], []

    def corner(self, x):
        x = tuple(round(c, 12) for c in x)
        if x not in self.corners:
            self.corners.append(x)
        return self.corners.index(x)

    def add(self, low, high, cells, grading):
        """From a quadrilateral to another; cells along its first side, its last and from one to the other."""
        a, b, d = ([p - q for p, q in zip(x, low[0])] for x in (low[1], low[3], high[0]))
        volume = (d[0] * (a[1] * b[2] - a[2] * b[1]) + d[1] * (a[2] * b[0] - a[0] * b[2])
                  + d[2] * (a[0] * b[1] - a[1] * b[0]))
        if volume < 0:
            low, high = ([q[0], q[3], q[2], q[1]] for q in (low, high))
            cells, grading = [[t[1], t[0], t[2]] for t in (cells, grading)]
        numbers = [self.corner(x) for x in (*low, *high)]
        self.hexes.append("hex (%d %d %d %d %d %d %d %d) " % tuple(numbers) + "(%d %d %d) " % tuple(cells)
                          + "simpleGrading (%.6g %.6g %.6g)" % tuple(grading))
        return numbers


def grid(m):
    """`m`: cells across an eighth of the girth."""
    blocks, on_sphere = Blocks(), []
    for signs, cells in (((1,), (m, m)), ((-1,), (m, m)), ("y", (2 * m, m)), ("z", (2 * m, m))):
        if signs == "y":
            quad = [(-1, 1, 0), (1, 1, 0), (1, 1, 1), (-1, 1, 1)]
        elif signs == "z":
            quad = [(-1, 0, 1), (1, 0, 1), (1, 1, 1), (-1, 1, 1)]
        else:
            quad = [(signs[0], 0, 0), (signs[0], 1, 0), (signs[0], 1, 1), (signs[0], 0, 1)]
        low = [tuple(radius * c / math.hypot(*q) for c in q) for q in quad]
        high = [tuple(shell * c for c in q) for q in quad]
        on_sphere.append(blocks.add(low, high, [*cells, 2 * m], [1, 1, 8])[:4])
    x, y = [(-4, -shell), (-shell, shell), (shell, 8)], [(0, shell), (shell, 4)]
    along = [(m, 0.4), (2 * m, 1), (5 * m // 2, 3)]
    across = [(m, 1), (m, 2.5)]
    ends = {"in": [], "out": []}
    for i, (x0, x1) in enumerate(x):
        for j, (y0, y1) in enumerate(y):
            for k, (z0, z1) in enumerate(y):
                if (i, j, k) == (1, 0, 0):
                    continue
                low = [(x0, y0, z0), (x1, y0, z0), (x1, y1, z0), (x0, y1, z0)]
                high = [(a, b, z1) for a, b, _ in low]
                n = blocks.add(low, high, [along[i][0], across[j][0], across[k][0]],
                               [along[i][1], across[j][1], across[k][1]])
                if i == 0:
                    ends["in"].append((n[0], n[4], n[7], n[3]))
                if i == 2:
                    ends["out"].append((n[1], n[2], n[6], n[5]))
    edges = {tuple(sorted((f[a], f[(a + 1) % 4]))) for f in on_sphere for a in range(4)}

    def faces(rows):
        return " ".join("(%d %d %d %d)" % tuple(r) for r in rows)
    return cases.foam("dictionary", "blockMeshDict", f"""scale 1;
geometry {{ball {{type searchableSphere; centre (0 0 0); radius {radius};}}}}
vertices ({" ".join("(%.12g %.12g %.12g)" % x for x in blocks.corners)});
blocks ({" ".join(blocks.hexes)});
edges ({" ".join("project %d %d (ball)" % e for e in sorted(edges))});
faces ({" ".join("project (%d %d %d %d) ball" % tuple(f) for f in on_sphere)});
defaultPatch {{name sides; type patch;}}
boundary (in {{type patch; faces ({faces(ends["in"])});}} out {{type patch; faces ({faces(ends["out"])});}}
          ball {{type wall; faces ({faces(on_sphere)});}});""")


def case(m, reynolds, dt):
    files = cases.ico_numerics(1e-6)
    for name, text in files.items():
        files[name] = text.replace("orthogonal", "corrected").replace("nNonOrthogonalCorrectors 0",
                                                                      "nNonOrthogonalCorrectors 1")
    return {
        **files,
        "system/blockMeshDict": grid(m),
        "system/controlDict": cases.control("icoFoam", dt, end, end) + """functions {
    drag {type forces; libs (forces); patches (ball); rho rhoInf; rhoInf 1; CofR (0 0 0); log false;
          executeControl timeStep; writeControl timeStep;}
}""",
        "constant/transportProperties": cases.foam("dictionary", "transportProperties",
                                                   f"nu [0 2 -1 0 0 0 0] {1 / reynolds:.12g};"),
        "0/U": cases.field("Vector", "U", "[0 1 -1 0 0 0 0]", "uniform (1 0 0)",
                           "in {type fixedValue; value uniform (1 0 0);} out {type inletOutlet; inletValue uniform "
                           "(0 0 0); value uniform (1 0 0);} sides {type slip;} ball {type noSlip;}"),
        "0/p": cases.field("Scalar", "p", "[0 2 -2 0 0 0 0]", "uniform 0",
                           "in {type zeroGradient;} out {type fixedValue; value uniform 0;} sides {type slip;} "
                           "ball {type zeroGradient;}"),
    }


def drag(m, reynolds):
    """C_d of the last quarter."""
    folder, log, _ = runs.solve(f"sphere_fitted_{m}_{reynolds}", case(m, reynolds, 0.24 / m), "icoFoam")
    found = []
    for line in next(folder.glob("postProcessing/drag/0/force.dat")).read_text().splitlines():
        if not line.startswith("#"):
            row = [float(word) for word in line.replace("(", " ").replace(")", " ").split()]
            if row[0] >= 0.75 * end:
                found.append(4 * row[1] / (math.pi / 8))
    steps = logs.steps(log)
    return {"reynolds": reynolds, "cells_across_an_eighth": m, "steps": len(steps),
            "cpu_s": f"{steps[-1]['seconds']:.0f}", "drag": f"{sum(found) / len(found):.5f}"}


if __name__ == "__main__":
    work.mkdir(parents=True, exist_ok=True)
    rows = []
    for m in [int(word) for word in sys.argv[1:]] or (8, 12):
        for reynolds in (100, 20):
            rows.append(drag(m, reynolds))
            print(rows[-1], flush=True)
    runs.save(root / "out" / "bench" / "openfoam_sphere_fitted.csv", rows,
              ": made by bench/peers/openfoam/sphere_fitted.py")
