"""Hard scenes of the STE database, its force extraction and its repair."""
