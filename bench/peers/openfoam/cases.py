"""Cases of icoFoam and interFoam: dictionaries and initial fields, written into a folder.

Written for OpenFOAM 1912 (Debian's openfoam). A case is a dictionary of file texts by path.
"""

import math

sides = {"x0": "(0 4 7 3)", "x1": "(2 6 5 1)", "y0": "(1 5 4 0)", "y1": "(3 7 6 2)", "z0": "(0 3 2 1)",
         "z1": "(4 5 6 7)"}


def foam(kind, name, body):
    return f"FoamFile {{version 2.0; format ascii; class {kind}; object {name};}}\n{body}\n"


def write(folder, files):
    """Puts a case into a folder that is empty or holds an older one."""
    for path, text in files.items():
        file = folder / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)


def mesh(lengths, cells, patches):
    """A box with a corner at the origin; patches: name -> (type and what it needs, sides)."""
    x, y, z = lengths
    corners = [(0, 0, 0), (x, 0, 0), (x, y, 0), (0, y, 0), (0, 0, z), (x, 0, z), (x, y, z), (0, y, z)]
    vertices = " ".join("(%.16g %.16g %.16g)" % c for c in corners)
    boundary = " ".join(f"{name} {{type {kind}; faces ({' '.join(sides[s] for s in of)});}}"
                        for name, (kind, of) in patches.items())
    return foam("dictionary", "blockMeshDict",
                f"scale 1; vertices ({vertices}); edges ();\n"
                f"blocks (hex (0 1 2 3 4 5 6 7) ({cells[0]} {cells[1]} {cells[2]}) simpleGrading (1 1 1));\n"
                f"boundary ({boundary});")


def control(application, dt, end, every, adjust=None):
    """Writes fields every so many seconds; `adjust`: largest Courant number, of the flow and of the surface."""
    automatic = (f"adjustTimeStep {'yes' if adjust else 'no'}; maxCo {adjust or 1}; maxAlphaCo {adjust or 1}; "
                 f"maxDeltaT 1; writeControl {'adjustableRunTime' if adjust else 'runTime'};")
    return foam("dictionary", "controlDict",
                f"application {application}; startFrom startTime; startTime 0; stopAt endTime; endTime {end:.12g};\n"
                f"deltaT {dt:.12g}; {automatic} writeInterval {every:.12g};\n"
                "writeFormat ascii; writePrecision 12; timePrecision 9; runTimeModifiable false;")


def in_ranks(ranks, cut="(1 2 1)"):
    return foam("dictionary", "decomposeParDict",
                f"numberOfSubdomains {ranks}; method simple; simpleCoeffs {{n {cut}; delta 0.001;}}")


def field(kind, name, dimensions, inside, boundary):
    return foam(f"vol{kind}Field", name,
                f"dimensions {dimensions};\ninternalField {inside};\nboundaryField {{{boundary}}}")


def vectors(rows):
    return "nonuniform List<vector>\n%d\n(\n%s\n)\n" % (len(rows), "\n".join("(%.12g %.12g %.12g)" % r for r in rows))


def scalars(rows):
    return "nonuniform List<scalar>\n%d\n(\n%s\n)\n" % (len(rows), "\n".join("%.12g" % r for r in rows))


# --- icoFoam: second order in space (linear) and time (backward) ---------------------------------------------


def ico_numerics(tolerance):
    return {
        "system/fvSchemes": foam("dictionary", "fvSchemes", """ddtSchemes {default backward;}
gradSchemes {default Gauss linear;}
divSchemes {default none; div(phi,U) Gauss linear;}
laplacianSchemes {default Gauss linear orthogonal;}
interpolationSchemes {default linear;}
snGradSchemes {default orthogonal;}"""),
        "system/fvSolution": foam("dictionary", "fvSolution", f"""solvers {{
    p {{solver GAMG; smoother GaussSeidel; tolerance {tolerance:g}; relTol 0.05;}}
    pFinal {{$p; relTol 0;}}
    U {{solver smoothSolver; smoother symGaussSeidel; tolerance 1e-6; relTol 0;}}
}}
PISO {{nCorrectors 2; nNonOrthogonalCorrectors 0; pRefCell 0; pRefValue 0;}}"""),
    }


def ico_cavity(cells, viscosity, dt, end, tolerance=1e-6, flat=False):
    """A lid of speed 1 along x drives a cube, or a square, of side 1."""
    patches = {"lid": ("wall", ["y1"]), "walls": ("wall", ["x0", "x1", "y0"] + ([] if flat else ["z0", "z1"]))}
    empty = ""
    if flat:
        patches["flat"] = ("empty", ["z0", "z1"])
        empty = "flat {type empty;}"
    depth, layers = (1 / cells, 1) if flat else (1, cells)
    return {
        "system/blockMeshDict": mesh((1, 1, depth), (cells, cells, layers), patches),
        "system/controlDict": control("icoFoam", dt, end, end),
        "system/decomposeParDict": in_ranks(2),
        **ico_numerics(tolerance),
        "constant/transportProperties": foam("dictionary", "transportProperties",
                                             f"nu [0 2 -1 0 0 0 0] {viscosity:.12g};"),
        "0/U": field("Vector", "U", "[0 1 -1 0 0 0 0]", "uniform (0 0 0)",
                     "lid {type fixedValue; value uniform (1 0 0);} walls {type noSlip;} " + empty),
        "0/p": field("Scalar", "p", "[0 2 -2 0 0 0 0]", "uniform 0",
                     "lid {type zeroGradient;} walls {type zeroGradient;} " + empty),
    }


def taylor_green(x, y, viscosity, t):
    """u, v, p of the vortices in a box of 2 pi."""
    decay = math.exp(-2 * viscosity * t)
    return (math.sin(x) * math.cos(y) * decay, -math.cos(x) * math.sin(y) * decay,
            0.25 * (math.cos(2 * x) + math.cos(2 * y)) * decay**2)


def centres(cells, side):
    """Of a square, in the order of its cells."""
    h = side / cells
    return [((i + 0.5) * h, (j + 0.5) * h) for j in range(cells) for i in range(cells)]


def ico_taylor_green(cells, viscosity, dt, end, tolerance=1e-7):
    side = 2 * math.pi
    patches = {name: (f"cyclic; neighbourPatch {other}", [name]) for name, other in
               (("x0", "x1"), ("x1", "x0"), ("y0", "y1"), ("y1", "y0"))}
    patches["flat"] = ("empty", ["z0", "z1"])
    start = [taylor_green(x, y, viscosity, 0) for x, y in centres(cells, side)]
    boundary = "".join(f"{name} {{type cyclic;}} " for name in ("x0", "x1", "y0", "y1")) + "flat {type empty;}"
    return {
        "system/blockMeshDict": mesh((side, side, side / cells), (cells, cells, 1), patches),
        "system/controlDict": control("icoFoam", dt, end, end),
        **ico_numerics(tolerance),
        "constant/transportProperties": foam("dictionary", "transportProperties",
                                             f"nu [0 2 -1 0 0 0 0] {viscosity:.12g};"),
        "0/U": field("Vector", "U", "[0 1 -1 0 0 0 0]", vectors([(u, v, 0) for u, v, _ in start]), boundary),
        "0/p": field("Scalar", "p", "[0 2 -2 0 0 0 0]", scalars([p for _, _, p in start]), boundary),
    }


# --- interFoam, as its tutorial of a dam break ---------------------------------------------------------------


def inter_numerics():
    return {
        "system/fvSchemes": foam("dictionary", "fvSchemes", """ddtSchemes {default Euler;}
gradSchemes {default Gauss linear;}
divSchemes {
    div(rhoPhi,U) Gauss linearUpwind grad(U);
    div(phi,alpha) Gauss vanLeer;
    div(phirb,alpha) Gauss linear;
    div(((rho*nuEff)*dev2(T(grad(U))))) Gauss linear;
}
laplacianSchemes {default Gauss linear corrected;}
interpolationSchemes {default linear;}
snGradSchemes {default corrected;}"""),
        "system/fvSolution": foam("dictionary", "fvSolution", """solvers {
    "alpha.water.*" {
        nAlphaCorr 2; nAlphaSubCycles 1; cAlpha 1; MULESCorr yes; nLimiterIter 5;
        solver smoothSolver; smoother symGaussSeidel; tolerance 1e-8; relTol 0;
    }
    "pcorr.*" {solver PCG; preconditioner DIC; tolerance 1e-5; relTol 0;}
    p_rgh {solver GAMG; smoother DIC; tolerance 1e-7; relTol 0.05;}
    p_rghFinal {$p_rgh; relTol 0;}
    U {solver smoothSolver; smoother symGaussSeidel; tolerance 1e-6; relTol 0;}
}
PIMPLE {momentumPredictor no; nOuterCorrectors 1; nCorrectors 3; nNonOrthogonalCorrectors 0;}
relaxationFactors {equations {".*" 1;}}"""),
    }


def water_and_air(gravity):
    return {
        "constant/transportProperties": foam("dictionary", "transportProperties",
                                             "phases (water air);\n"
                                             "water {transportModel Newtonian; nu 1e-06; rho 1000;}\n"
                                             "air {transportModel Newtonian; nu 1.48e-05; rho 1;} sigma 0.07;"),
        "constant/turbulenceProperties": foam("dictionary", "turbulenceProperties", "simulationType laminar;"),
        "constant/g": foam("uniformDimensionedVectorField", "g", f"dimensions [0 1 -2 0 0 0 0]; value {gravity};"),
    }


def inter_dam_break(lengths, cells, column, dt, end, every, adjust=None, flat=False):
    """A column of water (its extent along x and upwards) falls in a box that is open above. In three dimensions
    z is up, in two y is."""
    up = "y" if flat else "z"
    walls = ["x0", "x1", "y0"] if flat else ["x0", "x1", "y0", "y1", "z0"]
    patches = {"walls": ("wall", walls), "open": ("patch", [up + "1"])}
    empty = ""
    if flat:
        patches["flat"] = ("empty", ["z0", "z1"])
        empty = "flat {type empty;}"
    corner = (column[0], column[1], lengths[2]) if flat else (column[0], lengths[1], column[1])
    gravity = "(0 -9.81 0)" if flat else "(0 0 -9.81)"
    return {
        "system/blockMeshDict": mesh(lengths, cells, patches),
        "system/controlDict": control("interFoam", dt, end, every, adjust),
        "system/decomposeParDict": in_ranks(2),
        **inter_numerics(),
        "system/setFieldsDict": foam("dictionary", "setFieldsDict",
                                     "defaultFieldValues (volScalarFieldValue alpha.water 0);\n"
                                     "regions (boxToCell {box (-1 -1 -1) (%.12g %.12g %.12g); "
                                     "fieldValues (volScalarFieldValue alpha.water 1);});" % corner),
        **water_and_air(gravity),
        "0/U": field("Vector", "U", "[0 1 -1 0 0 0 0]", "uniform (0 0 0)",
                     "walls {type noSlip;} open {type pressureInletOutletVelocity; value uniform (0 0 0);} " + empty),
        "0/p_rgh": field("Scalar", "p_rgh", "[1 -1 -2 0 0 0 0]", "uniform 0",
                         "walls {type fixedFluxPressure; value uniform 0;} open {type totalPressure; p0 uniform 0;} "
                         + empty),
        "0/alpha.water": field("Scalar", "alpha.water", "[0 0 0 0 0 0 0]", "uniform 0",
                               "walls {type zeroGradient;} open {type inletOutlet; inletValue uniform 0; "
                               "value uniform 0;} " + empty),
    }
