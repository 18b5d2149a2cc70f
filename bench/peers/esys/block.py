# The bonded block at rest: bonds that carry moments, friction elsewhere. Arguments: workers, warm steps, timed steps,
# geometry.
import sys
import time

from esys.lsm import *
from esys.lsm.util import BoundingBox, Vec3

workers, warm, steps = (int(a) for a in sys.argv[1:4])
sim = LsmMpi(numWorkerProcesses=workers, mpiDimList=[workers, 1, 1])
sim.initNeighbourSearch(particleType="RotSphere", gridSpacing=0.025, verletDist=0.002)
sim.setNumTimeSteps(warm + steps + 10)
sim.setTimeStepSize(1.4e-5)
sim.setSpatialDomain(BoundingBox(Vec3(-0.2, -0.2, -0.2), Vec3(0.8, 0.8, 1.0)))
sim.readGeometry(sys.argv[4])
sim.setParticleDensity(tag=1, mask=-1, Density=2500.0)
sim.createInteractionGroup(RotBondPrms("bonds", 1e5, 28571.43, 1., 1., 1e9, 1e9, 1e9, 1e9, 0))
sim.createInteractionGroup(RotFrictionPrms("friction", 1e5, 0.5, 0.5, 28571.43))
sim.createExclusion("bonds", "friction")
sim.createInteractionGroup(LinDampingPrms(name="damping", viscosity=0.02, maxIterations=50))
for _ in range(warm):
    sim.runTimeStep()
begin = time.perf_counter()
for _ in range(steps):
    sim.runTimeStep()
print("timed %d steps %.6f s" % (steps, time.perf_counter() - begin), flush=True)
sim.exit()
