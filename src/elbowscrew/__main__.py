"""``python -m elbowscrew``."""

import sys

from elbowscrew.cli import command

sys.exit(command())
