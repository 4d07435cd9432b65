"""
Which speeds meet a natural mode?
=================================

Campbell diagram: mesh orders cross natural frequencies.
``loa.modes("scene.toml", speed_rpm=[0, 500, 1000])`` makes it.
"""

import lineofaction as loa

modes = loa.read("results/modes.nc", kind=loa.modes)
modes.plot()
print(modes)
