"""The joint's motion, its screw in every frame, and their errors."""
