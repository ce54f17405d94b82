"""The model: phases, laws, keyframes, what lies between them, and its comparison with others."""
