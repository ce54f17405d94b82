"""Which frame a word means: distal, proximal and lab are themselves, a segment's word is one end of the joint."""

from __future__ import annotations

from elbowscrew.choices import FRAMES, ExpressIn
from elbowscrew.errors import SettingError
from elbowscrew.joints import GENERIC, JOINTS, Joint, ends_called
from elbowscrew.model import QualityWarning


def frame_called(word: str, joint: Joint) -> tuple[ExpressIn, tuple[QualityWarning, ...]]:
    """Resolve a word of `Settings.express_in` for the joint that is analyzed.

    Where nothing says which joint it is, ``arm`` and ``forearm`` are an elbow's, as they always were, with a warning;
    another word must mean the same end in every joint.

    Raises
    ------
    SettingError
        If the joint has no such segment, or the word may mean either end.

    Examples
    --------
    >>> from elbowscrew.joints import joints_of
    >>> [frame_called("forearm", joints_of(name)[0])[0] for name in ("elbow", "wrist")]
    ['distal', 'proximal']
    """
    for frame in FRAMES:
        if word == frame:
            return frame, ()
    ends = ends_called(word, (joint,) if joint is not GENERIC else JOINTS)
    if len(ends) == 1:
        return ends.pop(), ()
    if joint is not GENERIC:
        msg = (
            f"--express-in {word}: the joint is the {joint.name}, between {joint.proximal.name} and "
            f"{joint.distal.name}; expected one of {', '.join(FRAMES)}, {joint.proximal.short}, {joint.distal.short}"
        )
        raise SettingError(msg)
    elbow: dict[str, ExpressIn] = {"arm": "proximal", "forearm": "distal"}
    if word not in elbow:
        msg = (
            f"--express-in {word}: proximal in one joint and distal in another, and the bodies' names do not say which "
            "joint this is; give --joint, or --express-in proximal or distal"
        )
        raise SettingError(msg)
    message = (
        f"--express-in {word} is taken for the {elbow[word]} body, as in an elbow: the bodies' names do not say which "
        "joint this is; give --joint"
    )
    return elbow[word], (QualityWarning(code="joint-not-known", message=message),)
