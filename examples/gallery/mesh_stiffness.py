"""
How stiff is the mesh?
======================

Tangent stiffness over the position: the parametric excitation of a dynamic model.
``loa.analyze("pair.toml")`` makes the table.
"""

import lineofaction as loa

table = loa.read("results/helical.nc", kind=loa.SteDatabase)
table.plot("mesh stiffness")
stiffness = 1.0 / table.tangent_compliance
print(f"{stiffness.min() / 1e6:.0f} to {stiffness.max() / 1e6:.0f} N/µm over position and load")
