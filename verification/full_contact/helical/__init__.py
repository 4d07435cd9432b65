"""Full contact of helical pairs: bodies in a frame that turns with the helix, contact in fine sections."""
