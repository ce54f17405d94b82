"""Laws of motion: derivatives, symmetry, and the peaks that are known of them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from elbowscrew.errors import SettingError
from elbowscrew.motion.interpolation.laws import LAWS, Law, asymmetric

# Highest velocity and acceleration of each, in units of the stroke over the time and over its square; closed forms.
PEAKS = {
    "cycloidal": (2.0, 2.0 * np.pi),
    "harmonic": (np.pi / 2.0, np.pi**2 / 2.0),
    "polynomial-345": (15.0 / 8.0, 10.0 / np.sqrt(3.0)),
    "polynomial-4567": (35.0 / 16.0, 7.5132),
    "modified-trapezoid": (2.0, 8.0 * np.pi / (2.0 + np.pi)),
    "modified-sine": (1.7596, 4.0 * np.pi**2 / (4.0 + np.pi)),
}


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("order", [0, 1, 2])
def test_each_derivative_is_that_of_the_one_before(name: str, order: int) -> None:
    """By integration, which does not mind jumps: the change of one is the area under the next."""
    law = LAWS[name]
    edges = np.linspace(0.0, 1.0, 41)
    nodes, weights = np.polynomial.legendre.leggauss(12)
    width = edges[1] - edges[0]
    inner = edges[:-1, None] + 0.5 * width * (nodes + 1.0)
    area = 0.5 * width * law[order + 1](inner) @ weights
    ends = [law[order](edges[:-1] + 1e-13), law[order](edges[1:] - 1e-13)]
    assert ends[1] - ends[0] == pytest.approx(area, abs=1e-9)


@pytest.mark.parametrize("name", PEAKS)
def test_peaks(name: str) -> None:
    tau = np.linspace(0.0, 1.0, 20_001)
    velocity, acceleration = PEAKS[name]
    assert LAWS[name].velocity(tau).max() == pytest.approx(velocity, rel=1e-4)
    assert LAWS[name].acceleration(tau).max() == pytest.approx(acceleration, rel=1e-4)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS.keys())
@given(peak=st.floats(0.05, 0.95))
def test_the_asymmetric_law_is_fastest_at_its_peak(law: Law, peak: float) -> None:
    stretched = asymmetric(law, peak)
    tau = np.linspace(0.0, 1.0, 2001)
    assert stretched(tau)[[0, -1]].tolist() == [0.0, 1.0]
    assert (np.diff(stretched(tau)) >= -1e-15).all()
    top = float(law.velocity(np.array(0.5)))
    assert stretched.velocity(np.array(peak)) == pytest.approx(top)
    assert stretched.velocity(tau).max() <= top + 1e-12
    both = stretched(np.array([peak - 1e-9, peak + 1e-9]))
    assert both == pytest.approx([peak, peak], abs=1e-8)


def test_half_way_is_no_change_and_the_ends_are_refused() -> None:
    tau = np.linspace(0.0, 1.0, 101)
    for law in LAWS.values():
        assert asymmetric(law, 0.5)(tau) == pytest.approx(law(tau), abs=1e-14)
    for peak in (0.0, 1.0, -0.2, 1e-310, 0.0499, 0.9501, float("nan")):
        with pytest.raises(SettingError, match=r"between 0\.05 and 0\.95"):
            asymmetric(LAWS["cycloidal"], peak)
