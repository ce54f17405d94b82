"""Figures as the bytes of files: the same result gives the same bytes."""

from __future__ import annotations

import io
import re
import struct
import zlib
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from typing import Any, Final

import numpy as np
from matplotlib.backend_bases import FigureCanvasBase
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

from elbowscrew._process import has_spare_cores
from elbowscrew.model import Analysis
from elbowscrew.plots.figures import WIDTH_MM
from elbowscrew.plots.layout import settle
from elbowscrew.plots.registry import FIGURES
from elbowscrew.plots.scale import draw_at_once
from elbowscrew.plots.style import publication_style
from elbowscrew.report.captions import caption_of
from elbowscrew.results.trial_views import view_of
from elbowscrew.view.figure_names import caption_file, has_figure
from elbowscrew.view.trial_view import TrialView

# Without dates and program versions the same analysis gives the same bytes.
_METADATA: Final[dict[str, dict[str, Any]]] = {
    "eps": {"Creator": "elbowscrew"},
    "svg": {"Date": None, "Creator": None},
    "pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}
_EPS_DATE: Final = re.compile(rb"^%%CreationDate:.*\n", re.MULTILINE)
_TIFF_DOTS_PER_INCH: Final = 600
_PNG: Final = b"\x89PNG\r\n\x1a\n"
_COMPRESSION: Final = 2  # a third of the time of the default, for a fifth more bytes
_MEMORY: Final = 6  # of 9: its tables stay in fast memory
_INCH_M: Final = 0.0254


def figure_files(
    trial: Analysis | TrialView,
    names: Sequence[str],
    formats: Sequence[str],
    width_mm: float = WIDTH_MM,
    font: str | None = None,
) -> dict[str, bytes]:
    """Draw figures of a trial.

    Parameters
    ----------
    trial : Analysis or TrialView
    names : sequence of str
        Of `elbowscrew.view.figure_names.FIGURE_ENTRIES`.
    formats : sequence of {"png", "svg", "pdf", "tiff", "eps"}
    width_mm : float
        Width on paper; the fonts keep their size.
    font : str, optional
        Family of the letters; that of the trial's settings by default.

    Returns
    -------
    dict of str to bytes
        Files by name, as in ``theta.png``, and the caption of each figure as in ``theta.caption.txt``; of figures that
        the trial has nothing for, none.

    Raises
    ------
    UsageError
        If there is no such font.
    """
    view = view_of(trial)
    drawn = [name for name in names if has_figure(name, view)]
    drawings = {name: partial(FIGURES[name], view, width_mm=width_mm) for name in drawn}
    captions = {caption_file(name): f"{caption_of(name, view)}\n".encode("utf-8", "replace") for name in drawn}
    return files_of(drawings, formats, font or view.settings.font) | captions


def files_of(
    drawings: Mapping[str, Callable[[], Figure]], formats: Sequence[str], font: str | None = None
) -> dict[str, bytes]:
    """Draw and save figures, one at a time, in all formats.

    Where there is another core, a PNG is compressed while the next figure is drawn.
    """
    files: dict[str, bytes] = {}
    compressed: dict[str, Future[bytes]] = {}
    with publication_style(font), ThreadPoolExecutor(max_workers=1) as background:
        for name, draw in drawings.items():
            figure = draw()
            settle(figure)
            draw_at_once(figure)
            for kind in formats:
                if kind == "png":
                    encode = partial(_png, _pixels(figure), figure.dpi)
                    if has_spare_cores():
                        compressed[f"{name}.png"] = background.submit(encode)
                    else:
                        files[f"{name}.png"] = encode()
                elif kind == "tiff":
                    files[f"{name}.tiff"] = _tiff(figure)
                else:
                    files[f"{name}.{kind}"] = _saved(figure, kind)
            FigureCanvasBase(figure)  # in place of the one with the pixels, which go at once and not with the garbage
    return files | {name: content.result() for name, content in compressed.items()}


def _saved(figure: Figure, kind: str) -> bytes:
    stream = io.BytesIO()
    figure.savefig(stream, format=kind, metadata=_METADATA[kind])
    content = stream.getvalue()
    return _EPS_DATE.sub(b"", content, count=1) if kind == "eps" else content


def _tiff(figure: Figure) -> bytes:
    """Draw a figure as journals ask for line art, with LZW compression."""
    usual = figure.dpi
    figure.set_dpi(_TIFF_DOTS_PER_INCH)
    try:
        image = Image.fromarray(_pixels(figure)).convert("RGB")
    finally:
        figure.set_dpi(usual)
    stream = io.BytesIO()
    resolution = _TIFF_DOTS_PER_INCH, _TIFF_DOTS_PER_INCH
    image.save(stream, format="tiff", dpi=resolution, compression="tiff_lzw")
    return stream.getvalue()


def _pixels(figure: Figure) -> NDArray[np.uint8]:
    """Draw a figure, shape (height, width, 4)."""
    canvas: Any = figure.canvas
    canvas.draw()
    return np.asarray(canvas.buffer_rgba(), dtype=np.uint8)


def _compressed(rows: NDArray[np.uint8]) -> bytes:
    stream = zlib.compressobj(_COMPRESSION, memLevel=_MEMORY)
    return stream.compress(rows.data) + stream.flush()


def _png(pixels: NDArray[np.uint8], dots_per_inch: float) -> bytes:
    """Write pixels (height, width, 4), but not how opaque they are, without a filter.

    Line art compresses better so, and in a quarter of the time.

    References
    ----------
    ISO/IEC 15948, Portable Network Graphics.
    """
    height, width, _ = pixels.shape
    rows = np.empty((height, 1 + 3 * width), dtype=np.uint8)
    rows[:, 0] = 0  # each begins with its filter, which is none
    for channel in range(3):  # a third of the time that a copy of all at once takes
        rows[:, 1 + channel :: 3] = pixels[..., channel]
    per_meter = round(dots_per_inch / _INCH_M)
    parts = (
        (b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)),
        (b"pHYs", struct.pack(">IIB", per_meter, per_meter, 1)),
        (b"IDAT", _compressed(rows)),
        (b"IEND", b""),
    )
    return _PNG + b"".join(
        struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
        for kind, content in parts
    )
