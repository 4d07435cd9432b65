"""Relations of a scene's parts: kinematics, rotors, lines of action, seats, freedoms."""

from dynamics.mechanism.planet_copies import with_planets

__all__ = ["with_planets"]
