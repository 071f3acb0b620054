# Stick-slip of a spring-slider that radiates, for the Python wrapper of QDYN.
from qdyn import qdyn

p = qdyn()
settings = {
    "MESHDIM": 0,  # a spring-slider
    "FRICTION_MODEL": "RSF",
    "MU": 2e10,
    "L": 1e1,
    "VS": 3000,
    "SIGMA": 5e6,
    "V_PL": 1e-6,
    "TMAX": 1e4,
    "ACC": 1e-10,
    "NTOUT": 10000,
}
friction = {"RNS_LAW": 0, "THETA_LAW": 1, "A": 0.01, "B": 0.025, "DC": 1e-5, "MU_SS": 0.6, "V_SS": 1e-6}
friction["V_0"] = 1.01 * settings["V_PL"]
friction["TH_0"] = friction["DC"] / settings["V_PL"]
settings["SET_DICT_RSF"] = friction

p.settings(settings)
p.render_mesh()
p.write_input()
p.run()
