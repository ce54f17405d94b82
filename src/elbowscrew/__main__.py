"""``python -m elbowscrew``."""

import sys

from elbowscrew.cli import main

sys.exit(main())
