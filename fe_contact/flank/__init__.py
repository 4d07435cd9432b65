"""The flank of a gear: the involute, and modifications along the profile, along the face and over both."""
