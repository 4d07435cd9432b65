"""
What tilts the mesh out of line?
================================

Misalignment under load by its cause. ``loa.deflect("scene.toml")`` finds it.
"""

import lineofaction as loa

deflected = loa.read("results/deflection.nc", kind=loa.deflect)
deflected.plot("misalignment by cause")
print(deflected)
