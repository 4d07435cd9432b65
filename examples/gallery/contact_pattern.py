"""
Where does the flank carry?
===========================

Contact pattern of a helical pair with tip relief and crowning.
``loa.flank("pair.toml", torque_n_m=80)`` makes it.
"""

import lineofaction as loa

pattern = loa.read("results/pressure.nc", kind=loa.flank)
pattern.plot("contact pattern")
print(pattern)
