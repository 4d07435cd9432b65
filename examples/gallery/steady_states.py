"""
Do rising and falling speed respond alike?
==========================================

Periodic steady states about a resonance. Both agree: teeth stay in contact. Where they part, curves jump.
``loa.steady("scene.toml", speed_rpm=[2400, 2500])`` finds them.
"""

import lineofaction as loa

states = loa.read("results/steady.nc", kind=loa.steady)
states.plot()
print(states)
