"""The Python interface: what `elbowscrew.analyze` and the others give, and how it shows itself in a notebook."""
