"""A channel over a bump for interFoam: a grid fitted to the bed, the start, the boundary conditions; x along, y up.

Debian's build of OpenFOAM 1912 has a fault that shows on grids that are not orthogonal: fvc::reconstruct, which makes
velocities of cells from fluxes, multiplies a tensor with a vector in the vector's own place, and in every cell of odd
number the y component takes the x component of the answer instead of the vector's. Where cells are upright boxes the
factor of it is 0. So sheared cells, those over the bump, get even numbers here, and upright ones odd numbers; in the
order of blockMesh interFoam fails within some ten steps, even from rest.
"""

import math

from cases import control, field, foam, inter_numerics, scalars, vectors, water_and_air

discharge = 0.11197  # [m2/s]
gravity = 9.81  # [m/s2]
height, half_length = 0.2, 0.6  # of the bump [m]
ends, top, end = (-1.2, 1.2), 0.48, 4.0  # [m], [m], [s]


def bed(x):
    return height * max(0.0, 1 - (x / half_length) ** 2) ** 2


def hydrostatic_depth(x):
    """Of a stream that is critical on the crest: the larger root of h + q^2 / (2 g h^2) = E before it, the smaller
    one after."""
    critical = (discharge**2 / gravity) ** (1 / 3)
    energy = height + 1.5 * critical - bed(x)
    angle = math.acos(max(-1.0, 1 - 27 * discharge**2 / (4 * gravity * energy**3)))
    return energy / 3 * (1 + 2 * math.cos((angle - (0 if x < 0 else 2 * math.pi)) / 3))


class Channel:
    """Cells of dx along, and upwards where the bed is flat; the bed is straight within each column."""

    def __init__(self, dx):
        self.dx, self.across, self.upwards = dx, round((ends[1] - ends[0]) / dx), round(top / dx)
        self.nodes = [ends[0] + i * dx for i in range(self.across + 1)]
        cells = [(i, k) for i in range(self.across) for k in range(self.upwards)]
        sheared = [c for c in cells if abs(self.nodes[c[0]] + 0.5 * dx) < half_length]
        upright = [c for c in cells if abs(self.nodes[c[0]] + 0.5 * dx) >= half_length]
        if len(sheared) != len(upright):
            raise ValueError("the bump must take half of the cells")
        self.cells = [c for pair in zip(sheared, upright) for c in pair]

    def column(self, i):
        """Middle, floor and size upwards of its cells."""
        floor = 0.5 * (bed(self.nodes[i]) + bed(self.nodes[i + 1]))
        return 0.5 * (self.nodes[i] + self.nodes[i + 1]), floor, (top - floor) / self.upwards

    def point(self, i, k, layer):
        return (i * (self.upwards + 1) + k) * 2 + layer

    def faces(self):
        """Points of the faces between cells, with owner and neighbour; those of each patch, with owner."""
        number = {cell: n for n, cell in enumerate(self.cells)}
        p = self.point
        inside, patches = [], {"inlet": [], "outlet": [], "bed": [], "open": [], "flat": []}
        for i, k in self.cells:
            here = number[i, k]
            along = [p(i + 1, k, 0), p(i + 1, k + 1, 0), p(i + 1, k + 1, 1), p(i + 1, k, 1)]
            up = [p(i, k + 1, 0), p(i, k + 1, 1), p(i + 1, k + 1, 1), p(i + 1, k + 1, 0)]
            for face, there, patch in ((along, (i + 1, k), "outlet"), (up, (i, k + 1), "open")):
                if there not in number:
                    patches[patch].append((face, here))
                elif here < number[there]:
                    inside.append((here, number[there], face))
                else:
                    inside.append((number[there], here, face[::-1]))
            if i == 0:
                patches["inlet"].append(([p(0, k, 1), p(0, k + 1, 1), p(0, k + 1, 0), p(0, k, 0)], here))
            if k == 0:
                patches["bed"].append(([p(i + 1, 0, 0), p(i + 1, 0, 1), p(i, 0, 1), p(i, 0, 0)], here))
            front = [p(i, k, 0), p(i, k + 1, 0), p(i + 1, k + 1, 0), p(i + 1, k, 0)]
            back = [n + 1 for n in front[::-1]]
            patches["flat"] += [(front, here), (back, here)]
        return sorted(inside), patches

    def mesh(self):
        inside, patches = self.faces()
        points = [(x, bed(x) + (top - bed(x)) * k / self.upwards, z)
                  for x in self.nodes for k in range(self.upwards + 1) for z in (0, self.dx)]
        outside = [face for of in patches.values() for face in of]
        faces = [face for _, _, face in inside] + [face for face, _ in outside]
        owners = [owner for owner, _, _ in inside] + [owner for _, owner in outside]
        kinds = {"bed": "wall", "flat": "empty"}
        boundary, first = [], len(inside)
        for name, of in patches.items():
            boundary.append(f"{name} {{type {kinds.get(name, 'patch')}; nFaces {len(of)}; startFace {first};}}")
            first += len(of)

        def listed(kind, name, rows):
            return foam(kind, name, f"{len(rows)}\n(\n" + "\n".join(rows) + "\n)")
        folder = "constant/polyMesh/"
        return {
            folder + "points": listed("vectorField", "points", ["(%.16g %.16g %.16g)" % q for q in points]),
            folder + "faces": listed("faceList", "faces", ["4(%d %d %d %d)" % tuple(f) for f in faces]),
            folder + "owner": listed("labelList", "owner", [str(n) for n in owners]),
            folder + "neighbour": listed("labelList", "neighbour", [str(n) for _, n, _ in inside]),
            folder + "boundary": listed("polyBoundaryMesh", "boundary", boundary),
        }

    def levels(self, share):
        """x and level of each column [m]: the water of its cells, droplets too, stands on the bed."""
        water = [0.0] * self.across
        for (i, _), wet in zip(self.cells, share):
            water[i] += wet * self.column(i)[2]
        columns = [self.column(i) for i in range(self.across)]
        return [x for x, _, _ in columns], [floor + h for (_, floor, _), h in zip(columns, water)]


def case(dx):
    """The start is the hydrostatic stream."""
    channel = Channel(dx)
    share, velocity = [], []
    for i, k in channel.cells:
        x, _, high = channel.column(i)
        depth = hydrostatic_depth(x)
        share.append(min(max(depth / high - k, 0.0), 1.0))
        velocity.append((discharge / depth if share[-1] > 0 else 0.0, 0, 0))
    still, flat = "value uniform (0 0 0);", "flat {type empty;}"
    return {
        **channel.mesh(),
        "system/controlDict": control("interFoam", 0.05 * dx, end, end, 0.5),
        **inter_numerics(),
        **water_and_air(f"(0 -{gravity} 0)"),
        "0/U": field("Vector", "U", "[0 1 -1 0 0 0 0]", vectors(velocity),
                     f"inlet {{type variableHeightFlowRateInletVelocity; flowRate {discharge * dx:.12g}; "
                     f"alpha alpha.water; {still}}} outlet {{type pressureInletOutletVelocity; {still}}} "
                     f"bed {{type slip;}} open {{type pressureInletOutletVelocity; {still}}} " + flat),
        "0/p_rgh": field("Scalar", "p_rgh", "[1 -1 -2 0 0 0 0]", "uniform 0",
                         "inlet {type fixedFluxPressure; value uniform 0;} outlet {type totalPressure; p0 uniform 0;} "
                         "bed {type fixedFluxPressure; value uniform 0;} open {type totalPressure; p0 uniform 0;} "
                         + flat),
        "0/alpha.water": field("Scalar", "alpha.water", "[0 0 0 0 0 0 0]", scalars(share),
                               "inlet {type variableHeightFlowRate; lowerBound 0; upperBound 1; value uniform 0;} "
                               "outlet {type inletOutlet; inletValue uniform 0; value uniform 0;} "
                               "bed {type zeroGradient;} "
                               "open {type inletOutlet; inletValue uniform 0; value uniform 0;} " + flat),
    }
