"""What trials of a study have together: statistics over subjects, in which one with more trials weighs no more."""
