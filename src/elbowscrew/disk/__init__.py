"""Files and folders put on disk: whole or not at all, in one step, and there to stay.

Everything that the program leaves on disk goes through `folders.new_folder` or `file_sets.write_set`; what a killed run
has left is swept by the next one.
"""
