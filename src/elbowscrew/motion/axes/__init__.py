"""Axes of moments and means: mean, from step to step, instantaneous."""
