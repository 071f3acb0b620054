# A step of the load point from 1 to 10 um/s, for rsfmodel.
import numpy as np
from rsfmodel import rsf, staterelations

model = rsf.Model()
model.mu0 = 0.6
model.a = 0.005
model.k = 1e-3  # friction per um
model.v = 1.0
model.vref = 1.0  # um/s

state1 = staterelations.DieterichState()
state1.b = 0.01
state1.Dc = 10.0  # um
model.state_relations = [state1]

rate = 100  # samples per second
model.time = np.arange(0, 40.01, 0.01)
lp_velocity = np.ones_like(model.time)
lp_velocity[10 * rate :] = 10.0
model.loadpoint_velocity = lp_velocity

model.solve()
