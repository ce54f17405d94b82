"""What a process of the program sets for itself, be it the command or a worker; a library leaves it to its user."""

from __future__ import annotations

import gc
import logging
import os
from typing import Final

# A figure makes a hundred thousand objects, and each full collection looks at all of the modules' objects again.
_OBJECTS_BETWEEN_COLLECTIONS: Final = 200_000


def set_up_process() -> None:
    """Let figures go to files without windows or words of their own, and collect garbage less often."""
    os.environ["MPLBACKEND"] = "agg"  # whatever the notebook or the shell prefers
    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # its words on fonts and caches are not the result
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # a search through all that is installed, for none
    gc.set_threshold(_OBJECTS_BETWEEN_COLLECTIONS)
