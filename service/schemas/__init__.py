"""JSON bodies of the service."""
