"""Hard scenes of multibody dynamics, on mesh-force tables in closed form: no finite elements are needed."""
