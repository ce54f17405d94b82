"""Movements, rests and cycles."""
