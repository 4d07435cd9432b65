"""Reading of foreign bytes: one confined child per request, within one set of limits."""
