"""A scene as elements and arrays: what the integrators advance."""
