"""Landmarks and the bones' angles."""
