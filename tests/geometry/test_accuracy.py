"""Every digit there is: against arithmetic in hundreds of digits, from no rotation to a full turn."""

from __future__ import annotations

import pytest
from multiprecision import ANGLES, SLIDES, UNIT_ROUNDOFF_BOUND, relative_errors


@pytest.mark.parametrize("slide", SLIDES)
@pytest.mark.parametrize("theta", ANGLES)
def test_relative_errors_are_what_the_conditioning_allows(theta: float, slide: float) -> None:
    for seed in range(3):
        for name, (error, allowed) in relative_errors(theta, slide, seed).items():
            assert error <= UNIT_ROUNDOFF_BOUND * allowed, name
