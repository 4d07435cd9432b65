"""Results on the flanks and in the roots at one operating point."""
