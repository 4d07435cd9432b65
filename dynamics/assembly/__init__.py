"""A scene as elements and arrays, which the integrators advance."""
