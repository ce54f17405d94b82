"""The view in space for a notebook: the one of the trial's page, in a frame of its own."""

from __future__ import annotations

import html
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final

from elbowscrew.errors import UsageError
from elbowscrew.interface.calls import StrPath
from elbowscrew.interface.python_words import public
from elbowscrew.model.mesh import Mesh
from elbowscrew.reading.meshes import read_mesh
from elbowscrew.report.trial_page import space_page
from elbowscrew.results.meshes_file import placed_meshes
from elbowscrew.view.trial_view import TrialView

_LEAST_PIXELS: Final = 100


@dataclass(frozen=True, slots=True, repr=False)
class SpaceView:
    """Bodies, axes and motion in space.

    Attributes
    ----------
    page : str
        HTML that needs no other file, and asks the network for nothing.
    height : int
        Pixels.
    """

    page: str
    height: int

    @classmethod
    def of(cls, view: TrialView, height: int, meshes: Mapping[str, Mesh | StrPath] | None) -> SpaceView:
        """Make the view of a trial; see `Analysis.view_3d`."""
        if not view.located:
            msg = "there are orientations and no positions, so that nothing has a place in space"
            raise UsageError(msg)
        if height < _LEAST_PIXELS:
            msg = f"height: expected {_LEAST_PIXELS} pixels at least, found {height}"
            raise UsageError(msg)
        read = {name: one if isinstance(one, Mesh) else public(read_mesh)(one) for name, one in (meshes or {}).items()}
        if read:
            view = replace(view, meshes=public(placed_meshes)(view, read))
        return cls(space_page(view), height)

    def __repr__(self) -> str:
        return "<view in space: shown in a notebook; page is its HTML>"

    def _repr_html_(self) -> str:
        source = html.escape(self.page, quote=True)
        look = f"width: 100%; height: {self.height}px; border: 0"
        return f'<iframe srcdoc="{source}" title="Bodies, axes and motion in space" style="{look}"></iframe>'
