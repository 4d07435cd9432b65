"""Results in a REXS document: attributes of origin ``calculated`` beside what the file says."""
