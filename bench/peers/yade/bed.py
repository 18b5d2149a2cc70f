# yade -j1 -n -x bed.py, with LAW=viscel|mindlin WARM=500 STEPS=300 SCENE=bed.xyz in the environment.
# YADE has no wall in a periodic cell, so the lowest layer of the bed is held.
import math
import os
import time

from yade import *

kn, kt, friction = 1e5, 28571.43, math.atan(0.5)
mass = 2500 * 4 / 3 * math.pi * 0.01**3 / 2  # of a pair, half of a sphere's

O.periodic = True
O.cell.setBox(0.54, 0.54, 5)
if os.environ["LAW"] == "viscel":
    material = ViscElMat(kn=2 * kn, ks=2 * kt, cn=2 * mass * 1883, cs=2 * mass * 941.5,
                         frictionAngle=friction, density=2500)
    stiffness, law = Ip2_ViscElMat_ViscElMat_ViscElPhys(), Law2_ScGeom_ViscElPhys_Basic()
else:
    material = FrictMat(young=1e8, poisson=0.25, frictionAngle=friction, density=2500)
    stiffness, law = Ip2_FrictMat_FrictMat_MindlinPhys(en=0.5, es=0.5), Law2_ScGeom_MindlinPhys_Mindlin()
O.materials.append(material)
for line in open(os.environ["SCENE"]):
    x, y, z = map(float, line.split())
    O.bodies.append(sphere((x, y, z + 0.5), 0.01, material=material, fixed=z < 0.0125))
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb()], verletDist=0.001),
    InteractionLoop([Ig2_Sphere_Sphere_ScGeom()], [stiffness], [law]),
    NewtonIntegrator(damping=0, gravity=(0, 0, -9.81)),
]
O.dt = 1.4e-5
O.run(int(os.environ["WARM"]), True)
steps = int(os.environ["STEPS"])
start = time.perf_counter()
O.run(steps, True)
seconds = time.perf_counter() - start
contacts = sum(1 for i in O.interactions if i.isReal)
print("timed", len(O.bodies), "spheres", steps, "steps", seconds, "s", contacts, "contacts", flush=True)
os._exit(0)  # its own way out may crash
