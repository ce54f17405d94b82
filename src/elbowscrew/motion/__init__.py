"""The study itself: from two bodies to the joint's screw motion, its model and their difference."""
