"""Contact analysis of gears, their dynamics and their noise."""
