"""Whether a hinge's axis wanders over the flexion, by how much, and where it is on the mean."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.sensitivity import NORMAL_95
from elbowscrew.geometry.twist import adjoint
from elbowscrew.motion.joint.influence import Influence, with_columns
from elbowscrew.motion.joint.interval import SURE, ClusterMotion, JointInterval, SkinMotion, joint_interval
from elbowscrew.motion.joint.joint_fit import HINGE_NUMBERS, LineFit

_GRID: Final = 400
_TILT_SHIFT: Final = (0, 1, 3, 4)
_WANDER_TILTS: Final = (HINGE_NUMBERS, HINGE_NUMBERS + 1)  # those of the wander stand behind the hinge's

TELLS_NOTHING: Final = np.radians(45.0)
"""Of a wander that would not be seen: no linear step tells of more."""


class Wander(NamedTuple):
    """A line that moves in proportion to the angle, from one end of the range to the other.

    Attributes
    ----------
    tilt, shift : float
        How far the axis tilts (rad) and moves across itself at the line's origin (m) over the whole range.
    unseen_tilt, unseen_shift : float
        A wander up to these would not be told from noise.
    significant : bool
        Whether one of the two is beyond its 99.73 % radius.
    step : ndarray, shape (P + 4,)
        From the hinge: its own numbers, then tilts x, y and shifts x, y of half the wander in the frame of the line.
    interval : JointInterval
        Of the same numbers: with the first four the mean axis', and not of the hinge, where the axis wanders.
    inverse : ndarray, shape (P + 4, P + 4)
        Covariance of the numbers under the stated noise.
    middle, half_range : float
        Of the angle, radians: the line is the mean one in the middle.
    pitch : float
        Of the fit, m/rad.
    grid : ndarray, shape (K,)
        Angles, evenly from one end to the other.
    summed : ndarray, shape (K, 6, 4)
        What the poses leave a hinge by there for each unit of the last four of `step`.
    """

    tilt: float
    shift: float
    unseen_tilt: float
    unseen_shift: float
    significant: bool
    step: Float
    interval: JointInterval
    inverse: Float
    middle: float
    half_range: float
    pitch: float
    grid: Float
    summed: Float

    @property
    def mean_rows(self) -> Float:
        """Rows (4, P + 4) of tilt and shift of the mean line in the proximal body, by the numbers."""
        return self.error_rows(np.array(self.middle))

    @property
    def mean_distal_rows(self) -> Float:
        """Rows (4, P + 4) of tilt and shift of the mean line in the distal body, by the numbers."""
        share = np.linspace(-1.0, 1.0, len(self.grid))
        return self._distal_rows(np.mean(share[:, None, None] * self._turned(self.grid), axis=0))

    def reference_rows(self, angle: Float, reference_angle: float) -> Float:
        """Rows (..., 4, P + 4) of the line at angles (...) in the distal body as it stands at a reference angle."""
        share = np.asarray((np.asarray(angle) - self.middle) / self.half_range)[..., None, None]
        rows = list(_TILT_SHIFT)
        summed = np.stack(
            [np.interp(reference_angle, self.grid, part) for part in self.summed.reshape(len(self.grid), -1).T]
        ).reshape(6, 4)
        return self._distal_rows(share * self._turned(np.array([reference_angle]))[0] - summed[rows])

    def _turned(self, angle: Float) -> Float:
        """Tilts and shifts (K, 4, 4) on the distal side of those on the proximal side, at angles (K,)."""
        return _columns(angle, self.pitch)[:, list(_TILT_SHIFT)]

    def _distal_rows(self, of_wander: Float) -> Float:
        rows = np.zeros((*of_wander.shape[:-1], len(self.step)))
        rows[..., range(4), range(4, 8)] = 1.0
        rows[..., -4:] = of_wander
        return rows

    def error_rows(self, angle: Float) -> Float:
        """Rows (..., 4, P + 4) that make the error of tilt and shift at angles (...) of that of the numbers."""
        share = (np.asarray(angle) - self.middle) / self.half_range
        rows = np.zeros((*share.shape, 4, len(self.step)))
        rows[..., range(4), range(4)] = 1.0
        rows[..., range(4), range(len(self.step) - 4, len(self.step))] = share[..., None]
        return rows


def wander_of_axis(
    fit: LineFit,
    influence: Influence,
    clusters: tuple[ClusterMotion, ...],
    *,
    skin: tuple[SkinMotion, ...] = (),
    reference_angle: float | None = None,
    noise_known: bool = True,
) -> Wander | None:
    """Test for a line that wanders with the angle, in one linear step from the fit.

    Parameters
    ----------
    fit : LineFit
    influence : Influence
        `influence_of_fit`.
    clusters, skin, reference_angle, noise_known
        As in `joint_interval`.

    Returns
    -------
    Wander or None
        None where the frames do not determine it, or would not show a wander of 45 deg.

    References
    ----------
    A motion about the lines ``b(theta)`` adds ``integral of b dB``, B the hinge's own columns of tilt and shift; so a
    constant b is the hinge's step, and the numbers are those of the line and not of the poses.
    """
    low, high = float(fit.angle.min()), float(fit.angle.max())
    if not high > low or not influence.determined:
        return None
    grid, summed = summed_columns(low, high, fit.pitch)
    columns = adjoint(fit.distal) @ columns_at(fit.angle, grid, summed)
    if influence.told is None:
        more, step = with_columns(influence, columns)
        inverse = more.inverse
    else:  # orientations tell of tilts alone
        more, step = with_columns(influence, columns[..., :2])
        more = more._replace(told=(*influence.told, *_WANDER_TILTS))
        inverse, step = _all_numbers(more, step)
    if not more.determined:
        return None
    interval = joint_interval(more, clusters, skin=skin, reference_angle=reference_angle, noise_known=noise_known)
    own = np.eye(len(step))
    tilt, shift = own[-4:-2], own[-2:]
    sizes = [float(np.linalg.norm(rows @ step)) for rows in (tilt, shift)]
    sure = [interval.radius(rows, SURE) for rows in (tilt, shift)]
    if not 2.0 * sure[0] < TELLS_NOTHING:
        return None
    return Wander(
        tilt=2.0 * sizes[0],
        shift=2.0 * sizes[1],
        unseen_tilt=2.0 * sure[0],
        unseen_shift=2.0 * sure[1],
        significant=any(size > limit for size, limit in zip(sizes, sure, strict=True)),
        step=step,
        interval=interval,
        inverse=inverse,
        middle=0.5 * (low + high),
        half_range=0.5 * (high - low),
        pitch=fit.pitch,
        grid=grid,
        summed=summed,
    )


def summed_columns(low: float, high: float, pitch: float = 0.0, sense: float = 1.0) -> tuple[Float, Float]:
    """Angles (K,) from one end to the other, and what a wander adds to the poses there, shape (K, 6, 4).

    Parameters
    ----------
    low, high : float
        Ends of the angle, radians.
    pitch : float
        m/rad.
    sense : float
        -1 where the other body turns about the line by the angle, 1 where this one stays.

    Returns
    -------
    tuple of ndarray
        The twists are on the distal side of the line; their mean over the angles is 0.
    """
    grid = np.linspace(low, high, _GRID)
    change = np.diff(_columns(sense * grid, pitch), axis=0)
    share = np.linspace(-1.0, 1.0, _GRID)
    wave = 0.5 * (share[1:] + share[:-1])
    summed = np.concatenate([np.zeros((1, 6, 4)), np.cumsum(wave[:, None, None] * change, axis=0)])
    return grid, summed - summed.mean(axis=0)


def columns_at(angle: Float, grid: Float, summed: Float) -> Float:
    """What `summed_columns` gives at the angles (F,) of the frames, shape (F, 6, 4)."""
    flat = summed.reshape(len(grid), -1).T
    return np.stack([np.interp(angle, grid, column) for column in flat], axis=1).reshape(-1, 6, 4)


def deviation_of_size(interval: JointInterval, step: Float, part: slice) -> float:
    """Standard deviation of a wander's size, along the way it goes; `part` is where its two numbers stand."""
    half = step[part]
    size = float(np.linalg.norm(half))
    row = np.zeros((1, len(step)))
    row[0, part] = half / size if size > 0.0 else [1.0, 0.0]
    return 2.0 * interval.radius(row) / NORMAL_95


def _columns(angle: Float, pitch: float) -> Float:
    """Tilts and shifts of the proximal line, as twists (..., 6, 4) on the distal side of the line at these angles."""
    half = np.zeros((len(angle), 6))
    half[:, 2], half[:, 5] = 0.5 * angle, 0.5 * pitch * angle
    return adjoint(dq.conjugate(dq.exp(half)))[:, :, list(_TILT_SHIFT)]


def _all_numbers(told: Influence, step: Float) -> tuple[Float, Float]:
    """Covariance and step of all numbers, 0 for those that orientations do not tell of."""
    places = list(told.told or ())
    inverse, whole = np.zeros((HINGE_NUMBERS + 4, HINGE_NUMBERS + 4)), np.zeros(HINGE_NUMBERS + 4)
    inverse[np.ix_(places, places)], whole[places] = told.inverse, step
    return inverse, whole
