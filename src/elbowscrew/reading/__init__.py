"""A recording out of a file: one reader a format behind one registry."""
