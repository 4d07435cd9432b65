"""
Which tip relief is quiet at which torque?
==========================================

Peak-to-peak transmission error over torque and tip relief of both gears: a relief is right for one load.
``loa.sweep("pair.toml", over=["torque", "tip_relief=0:24:3"], show=["peak_to_peak"])`` makes the map.
"""

import lineofaction as loa

ripple_map = loa.read("results/relief.nc", kind=loa.sweep)
ripple_map.plot()
print(ripple_map)
