"""Force waves of an electric machine, from a table in its units."""
