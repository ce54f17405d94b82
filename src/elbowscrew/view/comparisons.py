"""What figures and captions of compared models show."""

from __future__ import annotations

import numpy as np

from elbowscrew.model import ComparedModels, ComparedOverTrials


def has_displacements(models: ComparedModels | ComparedOverTrials) -> bool:
    """Tell whether models have displacements for errors; of orientations alone there are only angles."""
    errors = models.rms_displacement if isinstance(models, ComparedModels) else models.rms_displacement_mean
    return bool(np.isfinite(errors).any())
