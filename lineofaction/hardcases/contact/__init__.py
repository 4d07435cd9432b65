"""Hard scenes of loaded tooth contact, one file per family."""
