"""Which bodies are the joint's, and which of their poses are no measurement."""
