"""
How do the teeth share the load?
================================

Force on each pair of teeth through the mesh: one pair carries alone about the pitch point.
``loa.analyze("pair.toml")`` makes the table.
"""

import lineofaction as loa

table = loa.read("results/spur.nc", kind=loa.SteDatabase)
table.plot("load sharing")
alone = (table.load_share.max(axis=-1) > 0.999).mean()
print(f"one pair carries alone over {alone:.0%} of the positions and loads")
