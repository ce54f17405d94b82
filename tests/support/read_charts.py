"""A chart of a page read back from its SVG: what is drawn, in data units by the chart's own ticks."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import numpy as np
import pytest
from plain_pages import plain

from elbowscrew.geometry.arrays import Float

NUMBERS = re.compile(r"-?\d+(?:\.\d+)?")
TICK = re.compile(r"−?[\d.]+")


class Read:
    """Parts of a picture or of one of its panels, and values along and up by its ticks."""

    def __init__(self, root: ElementTree.Element) -> None:
        self.root = root
        assert not "".join(one.tail or "" for one in root.iter() if one is not root).strip(), "text beside the drawing"
        texts = [one for one in self.root.iter("text") if TICK.fullmatch(one.text or "")]
        along = [one for one in texts if one.get("text-anchor") == "middle"]
        up = [one for one in texts if one.get("text-anchor") == "end"]
        marks = [numbers(one)[0] for one in self.every("path", "tick")] or [float(one.get("x", "")) for one in along]
        self.x = line_through(marks, along)
        self.y = line_through([numbers(one)[1] for one in self.every("path", "grid")], up) if up else self.x

    @property
    def pixel(self) -> float:
        """Height of a pixel in data units."""
        return float(abs(self.y[0]))

    @property
    def words(self) -> list[str]:
        """Its texts that are no numbers of ticks."""
        return [one.text or "" for one in self.root.iter("text") if not TICK.fullmatch(one.text or "")]

    def every(self, tag: str, look: str) -> list[ElementTree.Element]:
        return [one for one in self.root.iter(tag) if one.get("class") == look]

    def outline(self, look: str) -> list[Float]:
        """Points (x, y) in data units of every path of that look."""
        found = []
        for path in self.every("path", look):
            points = np.array(numbers(path)).reshape(-1, 2)
            found.append(np.column_stack([np.polyval(self.x, points[:, 0]), np.polyval(self.y, points[:, 1])]))
        return found

    def dots(self, look: str) -> list[list[float]]:
        return [
            [
                float(np.polyval(self.x, float(one.get("cx", "")))),
                float(np.polyval(self.y, float(one.get("cy", "")))),
                float(one.get("r", "")),
            ]
            for one in self.every("circle", look)
        ]


def picture_in(html: str) -> ElementTree.Element:
    """The first picture there."""
    found = re.search(r'<svg class="chart".*?</svg>', html, re.S)
    assert found
    return ElementTree.fromstring(found[0])  # noqa: S314 - a page of ours


def keys_in(html: str) -> list[tuple[str, str, str]]:
    """Shape, look and words of each key of the legend."""
    return re.findall(r'<span><svg[^>]*><(\w+) class="([^"]+)"[^>]*/></svg> ([^<]*)</span>', plain(html))


def remarks_in(html: str) -> list[str]:
    """What is said among the keys of what is not drawn."""
    return re.findall(r"<span>([^<]+)</span>", plain(html))


def panels_in(html: str) -> list[Read]:
    """The panels of the first picture there, as they lie in the page."""
    return [Read(part) for part in picture_in(html) if part.tag == "g"]


def numbers(path: ElementTree.Element) -> list[float]:
    return [float(text) for text in NUMBERS.findall(path.get("d", ""))]


def line_through(pixels: list[float], texts: list[ElementTree.Element]) -> Float:
    values = [float((one.text or "").replace("−", "-")) for one in texts]
    assert len(values) == len(pixels) > 1
    line = np.polyfit(pixels, values, 1)
    assert np.polyval(line, pixels) == pytest.approx(values, abs=0.2 * abs(line[0]))
    return np.asarray(line)
