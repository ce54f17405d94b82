"""The joint as a whole."""
