"""Full contact by condensation: one mesh and one factorisation of each gear for all torques of a position."""
