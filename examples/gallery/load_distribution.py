"""
How even is the load over the face?
===================================

Load over the face width at four positions, their mean, and K_Hbeta.
``loa.flank("pair.toml", torque_n_m=80)`` makes it.
"""

import lineofaction as loa

pattern = loa.read("results/pressure.nc", kind=loa.flank)
pattern.plot("line load")
print(pattern)
