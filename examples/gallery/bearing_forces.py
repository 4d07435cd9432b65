"""
How large are the bearing forces over speed?
============================================

Transmission error, mesh force and bearing force by order.
``loa.response("scene.toml", speed_rpm=[100, 150])`` finds them.
"""

import lineofaction as loa

response = loa.read("results/response.nc", kind=loa.response)
response.plot()
print(response)
