"""The flank of a gear: the involute, and its modifications by what they act along."""
