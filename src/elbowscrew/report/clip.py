"""The view in space as a file: a clip of the motion, or a still; drawn as on the trial's page, without a browser."""

from __future__ import annotations

import io
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

import matplotlib as mpl
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from elbowscrew.errors import OutputError, UsageError
from elbowscrew.geometry.arrays import Bool, Float
from elbowscrew.geometry.quaternion import quat_from_rotation_vector, rotate, rotation_matrix_from_quat
from elbowscrew.model.mesh import Mesh
from elbowscrew.plots.style import AXES
from elbowscrew.report.scene import scene_of
from elbowscrew.results.meshes_file import placed_meshes
from elbowscrew.results.staging import settle, write_files
from elbowscrew.results.trial_views import view_of_result
from elbowscrew.view.long_trials import shown_part
from elbowscrew.view.scene import joint_bundle
from elbowscrew.view.trial_view import TrialView

KINDS: Final = (".gif", ".webm", ".png")
_FRAMES_PER_SECOND: Final = 20  # what GIF can say, in hundredths of a second
_LONGEST_S: Final = 8.0
"""A motion that takes longer is played faster, which is said."""
_SIZE: Final = (640, 520)
_STILL: Final = 3
_MOST_BYTES: Final = 6_000_000
_SMOOTH: Final = 2
_ALMOST_WHITE: Final = 248
# The page's colors on paper: told apart by color-blind readers, too, and in grey by their lightness.
_PAPER, _INK, _SOFT, _LIMB = "#ffffff", "#1b1f24", "#57606a", "#d7dbdf"
_COLORS: Final = {"proximal": "#0072b2", "distal": "#d55e00"}
_TURN: Final = (-0.3, -0.62)


def write_clip(result: Path, target: Path, *, meshes: Mapping[str, Mesh] | None = None, force: bool = False) -> Path:
    """Write the view in space of a finished result, whole or not at all.

    Parameters
    ----------
    result : Path
        A result folder.
    target : Path
        Its ending tells the kind: ``.gif``, ``.webm`` or ``.png``.
    meshes : mapping of str to Mesh, optional
        Bones to draw, by the segment or the name of their body; those of the result by default.
    force : bool
        Replace a file of that name.

    Raises
    ------
    UsageError
        If the ending is another one, ffmpeg is needed and missing, nothing has a place, or a mesh is of no body.
    ResultError
        If the result cannot be read.
    OutputError
        If the file is there already, or the disk does not take it.
    """
    kind = kind_of(target)
    settle(result)
    view = view_of_result(result)
    if meshes:
        view = replace(view, meshes=placed_meshes(view, meshes))
    write_files(target.parent, {target.name: clip_of(view, kind)}, replaceable=("",) if force else None)
    return target


def clip_of(view: TrialView, kind: str) -> bytes:
    """Draw bodies, axes and motion in space.

    Parameters
    ----------
    view : TrialView
        With places; bones are drawn if it has meshes. Of a long trial a stretch that stands for it.
    kind : {".gif", ".webm", ".png"}
        A clip of 8 s at most, or a still of the largest angle.

    Returns
    -------
    bytes
        The file.

    Raises
    ------
    UsageError
        If nothing has a place, or a ``.webm`` is wanted and there is no ffmpeg.
    """
    if not view.located:
        msg = "--clip: there are orientations and no positions, so that nothing has a place in space"
        raise UsageError(msg)
    shown, _ = shown_part(view)
    stage = _Stage.of(shown)
    if kind == ".png":
        best = int(np.nanargmax(stage.theta))
        return _encoded(stage.picture(best, _STILL), "png", dpi=(300, 300))
    rows, speed = _played(stage.time)
    if kind == ".webm":
        return _webm([stage.picture(row, 1, speed) for row in rows])
    for step in (1, 2, 3):
        pictures = [stage.picture(row, 1, speed) for row in rows[::step]]
        content = _gif(pictures, step * 1000 // _FRAMES_PER_SECOND)
        if len(content) <= _MOST_BYTES:
            break
    return content


def kind_of(path: Path) -> str:
    """Give the kind of a clip by its ending.

    Raises
    ------
    UsageError
        If it is none, or needs a program that is not there.
    """
    kind = path.suffix.casefold()
    if kind not in KINDS:
        msg = f"--clip {path}: expected a name that ends in {', '.join(KINDS)}"
        raise UsageError(msg)
    if kind == ".webm" and shutil.which("ffmpeg") is None:
        msg = f"--clip {path}: .webm needs the program ffmpeg, which is not installed; give a name that ends in .gif"
        raise UsageError(msg)
    return kind


def _played(time: Float) -> tuple[list[int], float]:
    """Rows of the pictures, evenly in time, and how many times faster than measured they are played."""
    duration = float(time[-1] - time[0])
    speed = max(duration / _LONGEST_S, 1.0)
    count = max(round(duration / speed * _FRAMES_PER_SECOND), 1) + 1
    wanted = np.linspace(time[0], time[-1], count)
    rows = np.clip(np.searchsorted(time, wanted), 0, len(time) - 1)
    return [int(row) for row in rows], speed


@dataclass(frozen=True, slots=True)
class _Stage:
    """What is drawn, millimeters, and from where it is seen.

    Attributes
    ----------
    scene : dict
        Of `elbowscrew.report.scene.scene_of`.
    turn, shift : ndarray, shape (N, 4) and (N, 3)
        Displacements of the distal body, NaN where not known.
    camera : ndarray, shape (3, 3)
        To the right, up, and toward the viewer.
    reach : float
        How far from the center things are.
    """

    scene: dict[str, Any]
    turn: Float
    shift: Float
    theta: Float
    time: Float
    camera: Float
    reach: float

    @classmethod
    def of(cls, view: TrialView) -> _Stage:
        scene = scene_of(view)
        turn, shift = _rows(scene["turn"], 4), _rows(scene["shift"], 3)
        distal = np.array(scene["distal"]["origin"])
        path = rotate(turn, distal) + shift
        center, direction = np.array(scene["center"]), joint_bundle(view).direction
        everything = [path, center + scene["half"] * direction, center - scene["half"] * direction]
        everything += [_points(scene["distal"]["markers"])]
        if scene["proximal"] is not None:
            everything += [_points([scene["proximal"]["origin"], *scene["proximal"]["markers"]])]
        reach = max(float(np.nanmax(_far(points - center))) for points in everything if np.size(points))
        bones = [_points(np.reshape(bone["vertices"], (-1, 3))) for bone in scene["bones"]]
        whole = max([0.0, *(float(_far(points - center).max()) for points in bones)])
        origin = None if scene["proximal"] is None else np.array(scene["proximal"]["origin"])
        toward = center - np.nanmean(path, axis=0) if origin is None else origin - center
        theta = np.array([np.nan if one is None else one for one in scene["theta"]])
        return cls(
            scene=scene,
            turn=turn,
            shift=shift,
            theta=theta,
            time=np.array(scene["time"]),
            camera=_camera(direction, toward, np.array(scene["across"][1])),
            reach=max(reach, min(2.0 * reach, whole)),
        )

    def picture(self, row: int, larger: int, speed: float = 1.0) -> Image.Image:
        """Draw one frame, `larger` times the usual size."""
        drawn = _Drawing(self, larger * _SMOOTH)
        scene = self.scene
        center, direction = np.array(scene["center"]), np.array(scene["direction"])
        origin = self._moved(row, [scene["distal"]["origin"]])
        drawn.bones(row)
        for at in (None if scene["proximal"] is None else np.array([scene["proximal"]["origin"]]), origin):
            if at is not None and not scene["bones"]:
                foot = center + ((at[0] - center) @ direction) * direction
                drawn.line([at[0], foot], _LIMB, 8.0)
        for segment, theta in zip(scene["segments"], scene["segmentTheta"], strict=True):
            drawn.line(np.reshape(segment, (2, 3)), self._color(theta, 0.55), 1.0)
        drawn.line(rotate(self.turn, np.array(scene["distal"]["origin"])) + self.shift, _COLORS["distal"], 1.6)
        self._axes(drawn, row)
        if scene["axis"][row] is not None and scene["point"][row] is not None:
            n, point = np.array(scene["axis"][row]), np.array(scene["point"][row])
            near = point + ((center - point) @ n) * n
            ends = [near - 1.1 * scene["half"] * n, near + 1.1 * scene["half"] * n]
            drawn.line(ends, _PAPER, 6.0)
            drawn.line(ends, self._color(scene["theta"][row]), 3.5)
        for end, body in (("proximal", scene["proximal"]), ("distal", scene["distal"])):
            if body is None:
                continue
            points = np.array([body["origin"], *body["markers"]])
            if end == "distal":
                points = self._moved(row, points)
            drawn.body(points, _COLORS[end], body["word"])
        drawn.words(self._told(row, speed))
        return drawn.finished()

    def _axes(self, drawn: _Drawing, row: int) -> None:
        """Draw the joint's own axes or center, else its one axis."""
        scene = self.scene
        for axis, look in zip(scene["joint"]["axes"], AXES, strict=False):
            along = axis["half"] * np.array(axis["direction"])
            ends = np.array([axis["center"] - along, axis["center"] + along])
            if axis["moves"]:
                ends = self._moved(row, ends)
            drawn.line(ends, look["color"], 2.6)
            drawn.label(ends[1], axis["name"], _INK)
        if scene["joint"]["center"] is not None:
            drawn.disc(np.array(scene["joint"]["center"]), 5.0, _INK)
        elif not scene["joint"]["axes"]:
            along = 1.15 * scene["half"] * np.array(scene["direction"])
            drawn.line([scene["center"] - along, scene["center"] + along], _INK, 2.6)

    def _told(self, row: int, speed: float) -> str:
        theta = self.scene["theta"][row]
        angle = "–" if theta is None else f"{theta:.1f}".replace("-", "−")
        faster = f"   {speed:.1f} times as fast" if speed > 1.0 else ""
        return f"{self.time[row]:.2f} s   θ {angle} deg{faster}"

    def _moved(self, row: int, points: Any) -> Float:
        moved: Float = rotate(self.turn[row], np.asarray(points, dtype=np.float64)) + self.shift[row]
        return moved

    def _color(self, theta: float | None, share: float = 1.0) -> str:
        low, high = self.scene["thetaRange"]
        colors: Sequence[str] = self.scene["colors"]
        place = 0.0 if theta is None else min(max((theta - low) / ((high - low) or 1.0), 0.0), 1.0)
        return _mixed(colors[round(place * (len(colors) - 1))], share)


class _Drawing:
    """A picture in the making; lengths of pens in pixels of the finished one."""

    def __init__(self, stage: _Stage, larger: int) -> None:
        self.stage, self.larger = stage, larger
        self.size = (_SIZE[0] * larger, _SIZE[1] * larger)
        self.image = Image.new("RGB", self.size, _PAPER)
        self.pen = ImageDraw.Draw(self.image)
        self.scale = 0.46 * min(self.size) / stage.reach
        self.font = ImageFont.truetype(str(Path(mpl.get_data_path(), "fonts", "ttf", "DejaVuSans.ttf")), 13 * larger)

    def at(self, points: Any) -> Float:
        """Places on the picture and depths, shape (..., 3), of points (..., 3)."""
        seen = (np.asarray(points, dtype=np.float64) - np.array(self.stage.scene["center"])) @ self.stage.camera.T
        return np.stack(
            [
                0.5 * self.size[0] + self.scale * seen[..., 0],
                0.5 * self.size[1] - self.scale * seen[..., 1],
                self.scale * seen[..., 2],
            ],
            axis=-1,
        )

    def line(self, points: Any, color: str, wide: float) -> None:
        places = self.at(points)
        known: Bool = np.logical_and.reduce(np.isfinite(places), axis=1)
        for piece in np.split(np.arange(len(places)), np.flatnonzero(~known)):
            inside = [tuple(place) for place in places[piece[known[piece]], :2].tolist()]
            if len(inside) > 1:
                self.pen.line(inside, color, round(wide * self.larger), joint="curve")

    def disc(self, point: Float, radius: float, color: str) -> None:
        x, y, _ = self.at(point).tolist()
        if x == x:
            r = radius * self.larger
            self.pen.ellipse((x - r, y - r, x + r, y + r), color, _PAPER, self.larger)

    def label(self, point: Float, text: str, color: str) -> None:
        x, y, _ = self.at(point).tolist()
        if x == x:
            self.pen.text(
                (x, y - 16 * self.larger),
                text,
                color,
                self.font,
                "mm",
                stroke_width=2 * self.larger,
                stroke_fill=_PAPER,
            )

    def body(self, points: Float, color: str, word: str) -> None:
        """Draw a body's origin, the first of the points, and its markers, joined."""
        origin, markers = points[0], points[1:]
        for k, marker in enumerate(markers):
            for other in markers[k + 1 :] if len(markers) < 5 else [origin]:
                self.line([marker, other], _mixed(color, 0.5), 1.0)
        for marker in markers:
            self.disc(marker, 4.0, color)
        self.disc(origin, 5.5, color)
        self.label(origin, word, color)

    def bones(self, row: int) -> None:
        """Draw the bones' triangles from back to front, each as dark as it is seen from the side."""
        faces, looks = [], []
        for bone in self.stage.scene["bones"]:
            points = np.reshape(bone["vertices"], (-1, 3))
            if bone["of"] == "distal":
                points = self.stage._moved(row, points)
            corners = self.at(points)[np.reshape(bone["faces"], (-1, 3))]
            if not np.isfinite(corners).all():
                continue
            across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            size = np.linalg.norm(across, axis=1)
            facing = np.abs(across[:, 2]) / np.where(size > 0.0, size, 1.0)
            share = (0.65 - 0.45 * facing)[:, None]
            own = np.array([int(_COLORS[bone["of"]][k : k + 2], 16) for k in (1, 3, 5)])
            faces.append(corners)
            looks.append(np.round(255.0 + share * (own - 255.0)).astype(int))
        if not faces:
            return
        corners, colors = np.concatenate(faces), np.concatenate(looks)
        order = np.argsort(corners[:, :, 2].sum(axis=1), kind="stable")
        flat = corners[order, :, :2].reshape(-1, 6).tolist()
        for corner, color in zip(flat, colors[order].tolist(), strict=True):
            self.pen.polygon(corner, tuple(color))

    def words(self, text: str) -> None:
        """Write the frame in a corner, and a ruler in another."""
        self.pen.text((14 * self.larger, 12 * self.larger), text, _INK, self.font)
        wanted = 0.2 * self.size[0] / self.scale
        ten = 10.0 ** np.floor(np.log10(wanted))
        length = next(k * ten for k in (5, 2, 1) if k * ten <= wanted)
        x, y = self.size[0] - 18 * self.larger, self.size[1] - 18 * self.larger
        self.pen.line([(x - length * self.scale, y), (x, y)], _INK, 2 * self.larger)
        self.pen.text((x, y - 6 * self.larger), f"{length:g} mm", _INK, self.font, "rs")

    def finished(self) -> Image.Image:
        return self.image.resize((self.size[0] // _SMOOTH, self.size[1] // _SMOOTH), Image.Resampling.BOX)


def _camera(direction: Float, toward: Float, across: Float) -> Float:
    """Look along the joint's axis with the proximal body above, then a little from above and from the side."""
    up = toward - (toward @ direction) * direction
    up = up / np.linalg.norm(up) if np.linalg.norm(up) > 1e-6 else across
    turned = rotation_matrix_from_quat(quat_from_rotation_vector([_TURN[0], 0.0, 0.0]))
    aside = rotation_matrix_from_quat(quat_from_rotation_vector([0.0, _TURN[1], 0.0]))
    return np.asarray(turned.T @ aside.T @ np.stack([np.cross(up, direction), up, direction]))


def _rows(values: Sequence[Sequence[float] | None], width: int) -> Float:
    return np.array([[np.nan] * width if one is None else one for one in values], dtype=np.float64)


def _points(values: Any) -> Float:
    return np.array(values, dtype=np.float64).reshape(-1, 3)


def _far(offsets: Float) -> Float:
    return np.asarray(np.linalg.norm(offsets, axis=-1))


def _mixed(color: str, share: float) -> str:
    """Mix a color with the paper's white."""
    parts = [round(255.0 + share * (int(color[k : k + 2], 16) - 255.0)) for k in (1, 3, 5)]
    return "#" + "".join(f"{part:02x}" for part in parts)


def _encoded(picture: Image.Image, kind: str, **options: Any) -> bytes:
    stream = io.BytesIO()
    picture.save(stream, format=kind, **options)
    return stream.getvalue()


def _gif(pictures: Sequence[Image.Image], milliseconds: int) -> bytes:
    """Write pictures with one palette, that of the middle one: still parts then stay as they are."""
    palette = pictures[len(pictures) // 2].quantize(96)
    colors = np.reshape(palette.getpalette() or [], (-1, 3))
    paper = (colors > _ALMOST_WHITE).all(axis=1, keepdims=True)
    palette.putpalette(np.where(paper, 255, colors).reshape(-1).tolist())
    drawn = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures]
    stream = io.BytesIO()
    drawn[0].save(
        stream, format="gif", save_all=True, append_images=drawn[1:], duration=milliseconds, loop=0, disposal=1
    )
    return stream.getvalue()


def _webm(pictures: Sequence[Image.Image]) -> bytes:
    """Have ffmpeg write a clip; it reads the pictures one after the other and writes to a pipe."""
    size = f"{_SIZE[0]}x{_SIZE[1]}"
    command = [
        shutil.which("ffmpeg") or "ffmpeg", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", size,
        "-r", str(_FRAMES_PER_SECOND), "-i", "-", "-c:v", "libvpx-vp9", "-pix_fmt", "yuv420p", "-b:v", "0",
        "-crf", "30", "-f", "webm", "-",
    ]  # fmt: skip
    done = subprocess.run(command, input=b"".join(map(_raw, pictures)), capture_output=True, check=False)  # noqa: S603
    if done.returncode or not done.stdout:
        why = " ".join(done.stderr.decode("utf-8", "replace").split())[:200]
        msg = f"--clip: ffmpeg made no clip: {why}; give a name that ends in .gif"
        raise OutputError(msg)
    return done.stdout


def _raw(picture: Image.Image) -> bytes:
    return picture.tobytes()
