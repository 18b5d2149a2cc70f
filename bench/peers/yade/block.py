# The bonded block at rest, concrete particle model (CPM, no moments): pairs nearer than 1.05 diameters are bonded.
# Environment: SCENE, WARM, STEPS.
import os
import time

from yade import *

reach = 1.05
material = O.materials.append(CpmMat(young=1e7, poisson=0.2, frictionAngle=0.46, density=2500., sigmaT=1e9,
                                     epsCrackOnset=1e-2, relDuctility=30, neverDamage=False))
for line in open(os.environ["SCENE"]):
    O.bodies.append(sphere([float(x) for x in line.split()[:3]], 0.01, material=material))
O.engines = [ForceResetter(),
             InsertionSortCollider([Bo1_Sphere_Aabb(aabbEnlargeFactor=reach)], verletDist=0.001),
             InteractionLoop([Ig2_Sphere_Sphere_ScGeom(interactionDetectionFactor=reach)],
                             [Ip2_CpmMat_CpmMat_CpmPhys(cohesiveThresholdIter=10)], [Law2_ScGeom_CpmPhys_Cpm()]),
             NewtonIntegrator(damping=0.2)]
O.dt = 1.4e-5
O.run(int(os.environ["WARM"]), True)
bonds = sum(1 for i in O.interactions if i.isReal)
steps = int(os.environ["STEPS"])
begin = time.perf_counter()
O.run(steps, True)
print("timed %d steps %.6f s %d bonds" % (steps, time.perf_counter() - begin, bonds), flush=True)
os._exit(0)
