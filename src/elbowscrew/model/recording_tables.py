"""Recordings as tables: a pandas data frame that is a plain table, and an xarray Dataset."""

from __future__ import annotations

from collections import Counter
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import numpy as np

from elbowscrew.choices import LengthUnit
from elbowscrew.errors import UsageError
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import pose_from_dual_quat
from elbowscrew.quantities import length_in

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from elbowscrew.model.recording import Recording, RigidBody


def frame_of_body(body: RigidBody, length_unit: LengthUnit) -> pd.DataFrame:
    """See `RigidBody.to_frame`."""
    import pandas as pd

    return pd.DataFrame({**_pose_columns(body, length_unit), "lost": body.loss_labels()})


def frame_of_recording(recording: Recording, length_unit: LengthUnit) -> pd.DataFrame:
    """See `Recording.to_frame`."""
    import pandas as pd

    columns: dict[str, Any] = {"frame": recording.frame, "time_s": recording.time_s}
    for name, body in zip(body_names(recording), recording.bodies, strict=True):
        columns |= {f"{name}_{part}": values for part, values in _pose_columns(body, length_unit).items()}
    for marker in recording.markers:
        columns |= {
            f"{marker.name}_{part}": values for part, values in _place_columns(marker.position, length_unit).items()
        }
    return pd.DataFrame(columns)


def dataset_of_recording(recording: Recording, length_unit: LengthUnit) -> xr.Dataset:
    """See `Recording.to_xarray`."""
    if find_spec("xarray") is None:
        msg = "to_xarray needs xarray; install it with: pip install xarray"
        raise UsageError(msg)
    import xarray as xr

    length = {"units": length_unit}
    poses = [pose_from_dual_quat(body.dual_quat_lab_body) for body in recording.bodies]
    places = [
        length_in(place, length_unit) if body.located else np.full_like(place, np.nan)
        for body, (_, place) in zip(recording.bodies, poses, strict=True)
    ]
    variables: dict[str, Any] = {}
    coords: dict[str, Any] = {"frame": recording.frame, "time": ("frame", recording.time_s, {"units": "s"})}
    if poses:
        losses = [body.loss_labels() for body in recording.bodies]
        variables = {
            "orientation": (("frame", "body", "quaternion"), np.stack([quat for quat, _ in poses], 1), {"units": "1"}),
            "position": (("frame", "body", "component"), np.stack(places, 1), length),
            "lost": (("frame", "body"), np.stack(losses, 1)),
        }
        coords |= {"body": body_names(recording), "quaternion": ["e0", "e1", "e2", "e3"]}
    if recording.markers:
        seen = np.stack([length_in(marker.position, length_unit) for marker in recording.markers], 1)
        variables["marker_position"] = (("frame", "marker", "component"), seen, length)
        coords["marker"] = [marker.name for marker in recording.markers]
    source = recording.source
    attributes = {"rate_hz": recording.rate_hz, "source": "" if source is None else source.path}
    return xr.Dataset(variables, {**coords, "component": ["x", "y", "z"]}, attributes)


def body_names(recording: Recording) -> list[str]:
    """Names of the bodies; bodies of one name have their identifier, or else their number, behind it."""
    count = Counter(body.name for body in recording.bodies)
    return [
        body.name if count[body.name] == 1 else f"{body.name} ({body.identifier or number})"
        for number, body in enumerate(recording.bodies, 1)
    ]


def _pose_columns(body: RigidBody, length_unit: LengthUnit) -> dict[str, Float]:
    quat, place = pose_from_dual_quat(body.dual_quat_lab_body)
    turned = {f"e{k}": quat[:, k] for k in range(4)}
    return turned | (_place_columns(place, length_unit) if body.located else {})


def _place_columns(position: Float, length_unit: LengthUnit) -> dict[str, Float]:
    return {
        f"{axis}_{length_unit}": values for axis, values in zip("xyz", length_in(position, length_unit).T, strict=True)
    }
