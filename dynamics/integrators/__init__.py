"""Compiled time integration with error control, and the static equilibrium a run starts from."""
