"""Filter, change of rate and gaps."""
