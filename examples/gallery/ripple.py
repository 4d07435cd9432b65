"""
How large is the ripple of a pair?
==================================

Transmission error over two base pitches at six torques. ``loa.analyze("pair.toml")`` makes the table.
"""

import lineofaction as loa

table = loa.read("results/spur.nc", kind=loa.SteDatabase)
table.plot()
print(f"{table.peak_to_peak(torque=100.0):um} peak to peak at 100 N m")
