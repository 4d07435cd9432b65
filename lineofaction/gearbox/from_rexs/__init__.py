"""From a REXS model to cases and a scene, with an account of every value of the file."""
