"""
How loud are the pairs that are made?
=====================================

Ripple of 200 pairs drawn within class 6 of ISO 1328.
``loa.scatter("pair.toml", tolerance_class=6)`` draws them.
"""

import lineofaction as loa

pairs = loa.read("results/scatter.nc", kind=loa.scatter)
pairs.plot()
print(pairs)
