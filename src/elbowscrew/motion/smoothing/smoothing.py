"""The filter that the two bodies go through, if one is asked for."""

from __future__ import annotations

from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowscrew.errors import SettingError
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import continuous_signs
from elbowscrew.model import RigidBody
from elbowscrew.motion.difference import DEFAULT_RADIUS
from elbowscrew.motion.smoothing.filtering import automatic_cutoff, lowpass_poses, noise_gain
from elbowscrew.motion.smoothing.gaps import fill_gaps
from elbowscrew.motion.tracking.clock import other_rate
from elbowscrew.settings import Settings

_STEP_TOLERANCE: Final = 0.5


def inside(measured: NDArray[np.bool_], elapsed: Float, rate_hz: float, margin: int) -> NDArray[np.bool_]:
    """Frames with so many measured ones on either side, on an even clock, shape (N,)."""
    usable = measured.copy()
    usable[1:] &= np.abs(np.diff(elapsed) * rate_hz - 1.0) <= _STEP_TOLERANCE  # after a hole in time a run begins anew
    known = np.concatenate([[0], np.cumsum(usable)])
    middle = np.arange(margin, measured.size - margin)
    found = np.zeros(measured.size, dtype=np.bool_)
    found[middle[known[middle + margin + 1] - known[middle - margin] == 2 * margin + 1]] = True
    return found


def _check_even(elapsed: Float, rate_hz: float) -> None:
    """Refuse to filter where the clock keeps another rate for a while: the cut-off would be another one there."""
    other = other_rate(elapsed, rate_hz)
    if other is not None:
        msg = (
            f"--lowpass: expected one rate, {rate_hz:g} frames per second, found {other[0]:.4g} from {other[1]:.4g} s "
            "on; give --resample HZ as well, which makes the clock even before the filter, or leave --lowpass out"
        )
        raise SettingError(msg)


class Smoothing(NamedTuple):
    """Cut-off of both bodies in hertz, None for no filter, and what it takes to apply it.

    Both are filtered alike: what they move together would else not cancel in the relative motion.
    """

    cutoff_hz: float | None
    elapsed: Float
    rate_hz: float
    broken_rows: NDArray[np.intp]
    max_gap_s: float

    @classmethod
    def of(
        cls,
        proximal: RigidBody | None,
        distal: RigidBody,
        elapsed: Float,
        rate_hz: float,
        broken_rows: NDArray[np.intp],
        settings: Settings,
    ) -> Smoothing:
        """Choose the cut-off that the settings ask for."""
        if settings.lowpass_hz is not None:
            _check_even(elapsed, rate_hz)
        none = cls(None, elapsed, rate_hz, broken_rows, settings.max_gap_s)
        if settings.lowpass_hz == "auto":
            return none.automatic(proximal, distal, settings)
        return none._replace(cutoff_hz=settings.lowpass_hz)

    def automatic(self, proximal: RigidBody | None, distal: RigidBody, settings: Settings) -> Smoothing:
        """Take the higher of the cut-offs that residual analysis finds for the two bodies."""
        radius = DEFAULT_RADIUS if settings.radius_mm is None else settings.radius_mm / 1000.0
        found = [
            automatic_cutoff(self._filled(body), self.elapsed, self.rate_hz, radius, self.broken_rows)
            for body in (proximal, distal)
            if body is not None
        ]
        return self._replace(cutoff_hz=max(found))

    def apply(self, proximal: RigidBody | None, distal: RigidBody) -> tuple[RigidBody | None, RigidBody]:
        """Filter the bodies; lost frames stay lost."""
        if self.cutoff_hz is None:
            return proximal, distal
        return None if proximal is None else self._filtered(proximal, self.cutoff_hz), self._filtered(
            distal, self.cutoff_hz
        )

    @property
    def margin(self) -> int:
        """Frames from the end of a run in which the filter leaves more of the noise than elsewhere."""
        return 0 if self.cutoff_hz is None else max(1, round(0.5 * self.rate_hz / self.cutoff_hz))

    def noise_gain(self, measured: NDArray[np.bool_]) -> Float:
        """Share of the variance of white noise that is left in each frame, shape (N,); all of it near a gap."""
        if self.cutoff_hz is None:
            return np.ones(measured.size)
        return np.where(
            inside(measured, self.elapsed, self.rate_hz, self.margin), noise_gain(self.rate_hz, self.cutoff_hz), 1.0
        )

    def _filtered(self, body: RigidBody, cutoff_hz: float) -> RigidBody:
        # Short gaps are bridged for the filter, so that it does not end at each of them, and opened again.
        smooth = lowpass_poses(self._filled(body), self.elapsed, self.rate_hz, cutoff_hz, self.broken_rows)
        smooth[~body.tracked] = np.nan
        return replace(body, dual_quat_lab_body=smooth)

    def _filled(self, body: RigidBody) -> Float:
        series = continuous_signs(body.dual_quat_lab_body)
        return fill_gaps(series, self.elapsed, self.rate_hz, self.max_gap_s, self.broken_rows)[0]
