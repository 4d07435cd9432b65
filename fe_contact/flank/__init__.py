"""The flank of a gear: the involute, the edge of its tip, and its modifications, one a file."""
