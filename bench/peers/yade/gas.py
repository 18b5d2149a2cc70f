# yade -j1 -n -x gas.py, with WARM=500 STEPS=500 SCENE=gas.xyzv in the environment: elastic, no friction.
import os
import time

from yade import *

side = (20000 * 4 / 3 * 3.141592653589793 * 1e-6 / 0.1) ** (1 / 3)
O.periodic = True
O.cell.setBox(side, side, side)
material = ViscElMat(kn=2e5, ks=2 * 28571.43, cn=0, cs=0, frictionAngle=0, density=2500)
O.materials.append(material)
for line in open(os.environ["SCENE"]):
    x, y, z, u, v, w = map(float, line.split())
    body = O.bodies.append(sphere((x, y, z), 0.01, material=material))
    O.bodies[body].state.vel = (u, v, w)
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb()], verletDist=0.0025),
    InteractionLoop([Ig2_Sphere_Sphere_ScGeom()], [Ip2_ViscElMat_ViscElMat_ViscElPhys()],
                    [Law2_ScGeom_ViscElPhys_Basic()]),
    NewtonIntegrator(damping=0),
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
