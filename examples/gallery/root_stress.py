"""
Where is the root stressed most?
================================

Stress of both tooth roots through the mesh. ``loa.root_stress("pair.toml", torque_n_m=100)`` makes it.
"""

import lineofaction as loa

roots = loa.read("results/root.nc", kind=loa.root_stress)
roots.plot()
print(roots)
