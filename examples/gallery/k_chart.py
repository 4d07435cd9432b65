"""
How much material does a modification remove?
=============================================

K-charts of a helical pair: the material that tip relief removes, over the roll angle. C is the pitch point.
``loa.analyze("pair.toml")`` makes the table; ``loa geometry pair.toml -o sheet.html`` draws them of a case.
"""

import lineofaction as loa

table = loa.read("results/helical.nc", kind=loa.SteDatabase)
table.plot("K-chart")
for gear, profile in table.to_dataframe("K-chart").groupby("curve"):
    start = profile["x"][profile["y"] > 0.0].min()
    print(f"{gear}: relief from a roll angle of {start:.1f}°, {profile['y'].max():.1f} µm at the tip")
