"""
Which mesh order grows with the torque?
=======================================

Ripple and mesh harmonics over the torque. Without relief all of them grow; a relief makes one torque quiet.
``loa.analyze("pair.toml")`` makes the table.
"""

import lineofaction as loa

table = loa.read("results/spur.nc", kind=loa.SteDatabase)
table.plot("ripple over torque")
for torque in table.torque:
    print(f"{torque:3.0f} N m: mesh order 1 {table.harmonics(torque=torque)[0]:um}")
