"""The gearbox: case, scene and unit, their files, and the studies of them."""
