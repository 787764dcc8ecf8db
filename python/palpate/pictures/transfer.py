"""Transfer functions: colour and extinction by value, as the page makes them (curve.ts)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from palpate.pictures.appearance import Colour
from palpate.pictures.looks import Preset, looks
from palpate.volumes.histogram import Anchors

__all__ = [
    "Transfer",
    "colour_at",
    "extinction_at",
    "linear_from_hex",
    "linear_from_srgb",
    "transfer_of_preset",
    "transfer_of_tissue",
]

Transfer = tuple[tuple[float, Colour, float], ...]
"""Value, linear colour and extinction [1/mm] of points by rising value."""

MOST_OPACITY = 0.995
"""More opaque is not told from opaque."""
PIECES = 6
"""Straight lines that stand for one of opacity, along which extinction is not straight."""
LEAST_SPAN = 1e-6
"""From soft tissue to bone, where a scan has one value."""


def linear_from_srgb(colour: tuple[float, float, float]) -> Colour:
    """Converts sRGB, each 0 to 1, to linear RGB (IEC 61966-2-1)."""
    red, green, blue = (c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in colour)
    return red, green, blue


def linear_from_hex(colour: str) -> Colour:
    """Converts "#rrggbb" to linear RGB."""
    red, green, blue = bytes.fromhex(colour.removeprefix("#"))
    return linear_from_srgb((red / 255.0, green / 255.0, blue / 255.0))


def transfer_of_tissue(anchors: Anchors) -> Transfer:
    """Returns the function that a scan is shown with first: bone in soft tissue."""
    tissue = looks().tissue
    span = max(anchors.bone - anchors.soft_tissue, LEAST_SPAN)
    middle = (anchors.soft_tissue + anchors.bone) / 2.0
    # equal steps of the page's slider look equal
    soft = tissue.weakest_soft * (tissue.strongest_soft / tissue.weakest_soft) ** tissue.soft_tissue
    return tuple(
        (
            middle + (stop.at - 0.5) * span,
            linear_from_hex(stop.colour),
            max(stop.soft * soft, stop.bone * tissue.bone),
        )
        for stop in tissue.stops
    )


def transfer_of_preset(preset: Preset, anchors: Anchors, limits: tuple[float, float]) -> Transfer:
    """Returns the function of a preset at the values of a scan.

    Args:
        preset: Its curves.
        anchors: Values of soft tissue and bone in the scan.
        limits: Its lowest value, and the one that hardly any voxel exceeds.
    """
    if preset.scale == "HU":
        in_hu = looks().anchors
        span = max(anchors.bone - anchors.soft_tissue, LEAST_SPAN)
        stretch = span / (in_hu.bone - in_hu.soft_tissue)
        offset = anchors.soft_tissue - in_hu.soft_tissue * stretch
    else:
        offset, stretch = limits[0], max(limits[1] - limits[0], LEAST_SPAN)
    opacity = np.array(preset.opacities, np.float64)
    places = np.array([value for value, _ in preset.colours])
    colours = np.array([linear_from_hex(colour) for _, colour in preset.colours])
    values = _divided(np.union1d(opacity[:, 0], places))
    percent = np.interp(values, opacity[:, 0], opacity[:, 1])
    mixed = [np.interp(values, places, channel) for channel in colours.T]
    return tuple(
        (offset + float(value) * stretch, _colour(*at), _extinction(float(share) / 100.0))
        for value, share, *at in zip(values, percent, *mixed, strict=True)
    )


def colour_at(transfer: Transfer, value: float) -> Colour:
    """Returns the colour at a value; outside of the points that of the nearest."""
    places = [at for at, _, _ in transfer]
    colours = np.array([colour for _, colour, _ in transfer])
    return _colour(*(np.interp(value, places, channel) for channel in colours.T))


def extinction_at(transfer: Transfer, value: float) -> float:
    """Returns the extinction at a value [1/mm]; outside of the points that of the nearest."""
    places, _, extinctions = zip(*transfer, strict=True)
    return float(np.interp(value, places, extinctions))


def _divided(ends: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns values that divide each span between two others into equal pieces."""
    shares = np.arange(PIECES) / PIECES
    inside = ends[:-1, None] + (ends[1:] - ends[:-1])[:, None] * shares
    return np.append(inside.ravel(), ends[-1])


def _colour(red: float, green: float, blue: float) -> Colour:
    return float(red), float(green), float(blue)


def _extinction(opacity: float) -> float:
    """Returns the extinction [1/mm] of which 1 mm has an opacity."""
    return -math.log(1.0 - min(MOST_OPACITY, max(0.0, opacity)))
