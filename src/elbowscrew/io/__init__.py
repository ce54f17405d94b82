"""Files in and out: one reader a format behind one registry, the tables, the summary, the result folder."""
