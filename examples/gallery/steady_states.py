"""
Do rising and falling speed respond alike?
==========================================

Periodic steady states about a resonance. Here both agree: the teeth stay in contact. Where teeth part, they jump.
``loa.steady("scene.toml", speed_rpm=[2400, 2500])`` finds them.
"""

import lineofaction as loa

states = loa.read("results/steady.nc")
states.plot()
print(states)
