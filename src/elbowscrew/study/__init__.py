"""Many trials: find them, analyze them on all cores or a cluster, and put one table beside their results.

Importing this package loads nothing heavy: a worker sets up its surroundings before NumPy is there.
"""
