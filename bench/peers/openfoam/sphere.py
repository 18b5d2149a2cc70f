"""A fixed sphere in a stream for OpenFOAM: its grid is a box, the sphere a volume that holds the water back.

Debian's OpenFOAM brings neither headers nor a compiler of coded sources, and its icoFoam knows no fvOptions. Its
pisoFoam does, with icoFoam's algorithm, and the porosity model `solidification` makes of a field a rate in each
cell, implicit in the equation of momentum: -rate(share) U, where `share` is the sphere's of the cell.
"""

import math

from cases import control, field, foam, mesh, scalars

lengths = (12, 8, 8)  # [diameters]
radius = 0.5


def centre(n, off):
    """As far off a corner of cells as tests/coupling/resolved_bodies.hpp has it; n cells to a diameter."""
    return tuple(4 + off / n * share for share in (1, 0.37, 0.71))


def chord(x, y, z, h):
    """How much of the line from x to x + h at y, z the sphere about the origin covers."""
    square = radius**2 - y * y - z * z
    if square <= 0:
        return 0.0
    half = math.sqrt(square)
    return max(0.0, min(x + h, half) - max(x, -half))


def shares(n, off, lines=32):
    """Cell by cell, x first: the share that the sphere covers, by lines^2 lines along x."""
    h, middle = 1 / n, centre(n, off)
    cells = [round(length * n) for length in lengths]
    found = [0.0] * math.prod(cells)
    near = [range(math.floor((c - radius) / h), math.floor((c + radius) / h) + 1) for c in middle]
    for i in near[0]:
        for j in near[1]:
            for k in near[2]:
                x, y, z = (m * h - c for m, c in zip((i, j, k), middle))
                covered = sum(chord(x, y + (a + 0.5) / lines * h, z + (b + 0.5) / lines * h, h)
                              for a in range(lines) for b in range(lines))
                found[i + cells[0] * (j + cells[1] * k)] = covered / (lines**2 * h)
    return found


def case(n, reynolds, dt, end, off, rate, tolerance=1e-5):
    """`rate`: share of the cell -> what holds the water in it back [1/s]."""
    rates = [rate(share) for share in shares(n, off)]
    solid = [c for c, r in enumerate(rates) if r > 0]
    U = ("in {type fixedValue; value uniform (1 0 0);} out {type inletOutlet; inletValue uniform (0 0 0); "
         "value uniform (1 0 0);} sides {type slip;}")
    rest = "in {type zeroGradient;} out {type fixedValue; value uniform 0;} sides {type slip;}"
    same = "in {type zeroGradient;} out {type zeroGradient;} sides {type slip;}"
    functions = """functions {
    rates {type readFields; libs (fieldFunctionObjects); fields (rate); readOnStart true;}
    force {type volFieldValue; libs (fieldFunctionObjects); fields (U); operation weightedVolIntegrate;
           weightField rate; regionType cellZone; name solid; writeFields false; log false;
           executeControl timeStep; writeControl timeStep; writePrecision 10;}
}"""
    return {
        "system/blockMeshDict": mesh(lengths, [round(length * n) for length in lengths],
                                     {"in": ("patch", ["x0"]), "out": ("patch", ["x1"]),
                                      "sides": ("patch", ["y0", "y1", "z0", "z1"])}),
        "system/topoSetDict": foam("dictionary", "topoSetDict",
                                   "actions ({name covered; type cellSet; action new; source labelToCell; value ("
                                   + " ".join(map(str, solid)) + ");}\n{name solid; type cellZoneSet; action new; "
                                   "source setToCellZone; set covered;});"),
        "system/controlDict": control("pisoFoam", dt, end, end) + functions,
        "system/fvSchemes": foam("dictionary", "fvSchemes", """ddtSchemes {default backward;}
gradSchemes {default Gauss linear;}
divSchemes {default none; div(phi,U) Gauss linear; div((nuEff*dev2(T(grad(U))))) Gauss linear;}
laplacianSchemes {default Gauss linear orthogonal;}
interpolationSchemes {default linear;}
snGradSchemes {default orthogonal;}"""),
        "system/fvSolution": foam("dictionary", "fvSolution", f"""solvers {{
    p {{solver GAMG; smoother GaussSeidel; tolerance {tolerance:g}; relTol 0.05;}}
    pFinal {{$p; relTol 0;}}
    "U.*" {{solver smoothSolver; smoother symGaussSeidel; tolerance {tolerance:g}; relTol 0;}}
}}
PISO {{nCorrectors 2; nNonOrthogonalCorrectors 0;}}"""),
        "constant/transportProperties": foam("dictionary", "transportProperties",
                                             f"transportModel Newtonian; nu {1 / reynolds:.12g};"),
        "constant/turbulenceProperties": foam("dictionary", "turbulenceProperties", "simulationType laminar;"),
        "constant/fvOptions": foam("dictionary", "fvOptions", """sphere {
    type explicitPorositySource; active true;
    explicitPorositySourceCoeffs {
        type solidification; selectionMode cellZone; cellZone solid;
        solidificationCoeffs {
            T rate; alpha none; D table ((0 0) (1e9 1e9));
            coordinateSystem {type cartesian; origin (0 0 0); rotation {type none;}}
        }
    }
}"""),
        "0/U": field("Vector", "U", "[0 1 -1 0 0 0 0]", "uniform (1 0 0)", U),
        "0/p": field("Scalar", "p", "[0 2 -2 0 0 0 0]", "uniform 0", rest),
        "0/rate": field("Scalar", "rate", "[0 0 0 0 0 0 0]", scalars(rates), same),
    }


def drags(folder):
    """Time and C_d after each step: the penalisation's force on the water, opposite, is that on the sphere."""
    found = []
    for line in next(folder.glob("postProcessing/force/0/*.dat")).read_text().splitlines():
        if not line.startswith("#"):
            row = [float(word) for word in line.replace("(", " ").replace(")", " ").split()]
            found.append((row[0], row[1] / (math.pi * radius**2 / 2)))
    return found
