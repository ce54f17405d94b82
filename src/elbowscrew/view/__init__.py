"""What figures and pages need of a trial, from memory or from disk."""
