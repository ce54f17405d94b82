"""Laws of motion: how far the motion is, t in [0, 1], at the time tau in [0, 1] of a phase, and its derivatives."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, NamedTuple

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import ArrayLike

from elbowscrew import plug_ins
from elbowscrew.choices import CLOSED_LAWS, LAW_PEAKS, functions_named
from elbowscrew.errors import SettingError, UsageError
from elbowscrew.geometry.arrays import Float

_ENDS: Final = 1e-9
_Function = Callable[[Float], Float]


class Law(NamedTuple):
    """A law from rest to rest (but for the linear one), symmetric about tau = 1/2; called, it gives t.

    Attributes
    ----------
    position, velocity, acceleration, jerk : callable
        Functions of tau, shape (...), giving t and its derivatives by tau, shape (...), in closed form. Where a
        derivative jumps they give the value after the jump, at tau = 1 the one before.
    """

    position: _Function
    velocity: _Function
    acceleration: _Function
    jerk: _Function

    def __call__(self, tau: ArrayLike) -> Float:
        """Share of the motion, shape (...), at tau."""
        return self.position(np.asarray(tau, dtype=np.float64))


def _cycloidal() -> Law:
    w = 2.0 * np.pi
    return Law(
        lambda x: x - np.sin(w * x) / w,
        lambda x: 1.0 - np.cos(w * x),
        lambda x: w * np.sin(w * x),
        lambda x: w**2 * np.cos(w * x),
    )


def _harmonic() -> Law:
    w = np.pi
    return Law(
        lambda x: 0.5 * (1.0 - np.cos(w * x)),
        lambda x: 0.5 * w * np.sin(w * x),
        lambda x: 0.5 * w**2 * np.cos(w * x),
        lambda x: -0.5 * w**3 * np.sin(w * x),
    )


def _polynomial(*coefficients: float) -> Law:
    p = Polynomial(coefficients)
    return Law(*(_evaluated(p.deriv(k)) for k in range(4)))


def _evaluated(p: Polynomial) -> _Function:
    return lambda x: np.asarray(p(x), dtype=np.float64) + np.zeros(x.shape)


def _modified_sine() -> Law:
    """Quarter waves of the acceleration: a fast one at either end, a slow half wave between (Neklutin; Norton 2009)."""
    peak = 4.0 * np.pi**2 / (np.pi + 4.0)

    def acceleration(x: Float) -> Float:
        slow = np.cos(4.0 * np.pi / 3.0 * (x - 0.125))
        return peak * np.where(x < 0.125, np.sin(4.0 * np.pi * x), slow)

    def velocity(x: Float) -> Float:
        fast = (1.0 - np.cos(4.0 * np.pi * x)) / (4.0 * np.pi)
        slow = 1.0 / (4.0 * np.pi) + 0.75 / np.pi * np.sin(4.0 * np.pi / 3.0 * (x - 0.125))
        return peak * np.where(x < 0.125, fast, slow)

    def position(x: Float) -> Float:
        fast = x / (4.0 * np.pi) - np.sin(4.0 * np.pi * x) / (16.0 * np.pi**2)
        start = 0.125 / (4.0 * np.pi) - 1.0 / (16.0 * np.pi**2)
        slow = (x - 0.125) / (4.0 * np.pi) + 9.0 / (16.0 * np.pi**2) * (1.0 - np.cos(4 * np.pi / 3 * (x - 0.125)))
        return peak * np.where(x < 0.125, fast, start + slow)

    def jerk(x: Float) -> Float:
        slow = -4.0 * np.pi / 3.0 * np.sin(4.0 * np.pi / 3.0 * (x - 0.125))
        return peak * np.where(x < 0.125, 4.0 * np.pi * np.cos(4.0 * np.pi * x), slow)

    return _from_first_half(Law(position, velocity, acceleration, jerk))


def _modified_trapezoid() -> Law:
    """Acceleration that rises as a sine in an eighth, stays for a quarter, and falls as a sine (Norton 2009)."""
    peak = 8.0 * np.pi / (np.pi + 2.0)
    w = 4.0 * np.pi

    def pieces(x: Float, rising: Float, constant: Float, falling: Float) -> Float:
        return peak * np.where(x < 0.125, rising, np.where(x < 0.375, constant, falling))

    def acceleration(x: Float) -> Float:
        return pieces(x, np.sin(w * x), np.ones(x.shape), np.cos(w * (x - 0.375)))

    def velocity(x: Float) -> Float:
        at_constant, at_falling = 1.0 / w, 1.0 / w + 0.25
        return pieces(
            x,
            (1.0 - np.cos(w * x)) / w,
            at_constant + (x - 0.125),
            at_falling + np.sin(w * (x - 0.375)) / w,
        )

    def position(x: Float) -> Float:
        at_constant = 0.125 / w - 1.0 / w**2
        at_falling = at_constant + 0.25 / w + 0.5 * 0.25**2
        return pieces(
            x,
            x / w - np.sin(w * x) / w**2,
            at_constant + (x - 0.125) / w + 0.5 * (x - 0.125) ** 2,
            at_falling + (1.0 / w + 0.25) * (x - 0.375) + (1.0 - np.cos(w * (x - 0.375))) / w**2,
        )

    def jerk(x: Float) -> Float:
        return pieces(x, w * np.cos(w * x), np.zeros(x.shape), -w * np.sin(w * (x - 0.375)))

    return _from_first_half(Law(position, velocity, acceleration, jerk))


def _from_first_half(law: Law) -> Law:
    """Continue a law by its symmetry, ``t(1 - tau) = 1 - t(tau)``; its derivatives are odd and even in turn."""

    def continued(function: _Function, sign: float, offset: float) -> _Function:
        return lambda x: np.where(x < 0.5, function(x), offset + sign * function(1.0 - x))

    return Law(
        continued(law.position, -1.0, 1.0),
        continued(law.velocity, 1.0, 0.0),
        continued(law.acceleration, -1.0, 0.0),
        continued(law.jerk, 1.0, 0.0),
    )


def asymmetric(law: Law, peak: float) -> Law:
    """Move the time of a symmetric law's highest velocity from tau = 1/2 to `peak`, within `LAW_PEAKS`.

    Either half is stretched in time and in share alike, so that the velocity stays as high and the acceleration
    continuous: ``t = 2 p law(tau / (2 p))`` up to p, and by symmetry from there.
    """
    if not LAW_PEAKS[0] <= peak <= LAW_PEAKS[1]:
        msg = f"the time of the highest velocity must lie between {LAW_PEAKS[0]:g} and {LAW_PEAKS[1]:g}, found {peak:g}"
        raise SettingError(msg)

    def stretched(order: int, first_sign: float, offset: float) -> _Function:
        function = law[order]

        def value(x: Float) -> Float:
            early = (2.0 * peak) ** (1 - order) * function(np.minimum(x / (2.0 * peak), 0.5))
            rest = 1.0 - peak
            late = (2.0 * rest) ** (1 - order) * function(np.minimum((1.0 - x) / (2.0 * rest), 0.5))
            return np.where(x < peak, early, offset + first_sign * late)

        return value

    return Law(stretched(0, -1.0, 1.0), stretched(1, 1.0, 0.0), stretched(2, -1.0, 0.0), stretched(3, 1.0, 0.0))


cycloidal: Final = _cycloidal()
"""``t = tau - sin(2 pi tau)/(2 pi)``: rest to rest without a jump in acceleration (P 36)."""


def _linear() -> Law:
    return _polynomial(0.0, 1.0)


def _polynomial_345() -> Law:
    """Minimum jerk."""
    return _polynomial(0.0, 0.0, 0.0, 10.0, -15.0, 6.0)


def _polynomial_4567() -> Law:
    return _polynomial(0.0, 0.0, 0.0, 0.0, 35.0, -84.0, 70.0, -20.0)


LAWS: Final[dict[str, Law]] = {name: law() for name, law in functions_named(CLOSED_LAWS, globals()).items()}
"""A new law is one function above, and its name in `elbowscrew.choices.ClosedLaw`."""


def named_law(name: str, peak: float | None = None) -> Law:
    """Give a law by its name, with the time of its highest velocity as a share of the phase if that is not the middle.

    Raises
    ------
    SettingError
        If there is no such law in closed form.
    """
    if not is_closed(name):
        msg = f"--law {name}: not a law in closed form; expected one of {', '.join(LAWS)}"
        raise SettingError(msg)
    law = LAWS[name] if name in LAWS else _plugged(name)
    return law if peak is None else asymmetric(law, peak)


def is_closed(name: str) -> bool:
    """Whether a law is one in closed form: ours, or a plug-in's."""
    return name in LAWS or name in plug_ins.names(plug_ins.LAWS)


def _plugged(name: str) -> Law:
    """Load a law of another distribution, and check that it is what a law must be.

    Raises
    ------
    UsageError
        If it does not go from 0 to 1, or is not symmetric.
    """
    law = plug_ins.loaded(plug_ins.LAWS, name, Law)
    tau = np.linspace(0.0, 1.0, 101)
    try:
        t = np.asarray(law(tau), dtype=np.float64)
        derivatives = [np.asarray(function(tau), dtype=np.float64) for function in law[1:]]
    except (Exception, SystemExit) as error:  # it is not ours
        msg = f"{plug_ins.told(plug_ins.LAWS, name)} failed: {plug_ins.brief(error)}"
        raise UsageError(msg) from error
    fits = all(part.shape == tau.shape and np.isfinite(part).all() for part in (t, *derivatives))
    if not (fits and abs(t[0]) < _ENDS and np.abs(t + t[::-1] - 1.0).max() < _ENDS):
        whose = plug_ins.told(plug_ins.LAWS, name)
        msg = f"{whose}: expected t from 0 to 1, symmetric about tau = 1/2, and its derivatives"
        raise UsageError(msg)
    return law
