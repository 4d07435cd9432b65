"""The contact of a pair at operating points."""
