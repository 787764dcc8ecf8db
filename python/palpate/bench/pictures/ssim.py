"""Structural similarity of two pictures.

Source: Z. Wang, A. C. Bovik, H. R. Sheikh, E. P. Simoncelli, "Image quality assessment: from error
visibility to structural similarity", IEEE Transactions on Image Processing 13 (2004), with the
authors' Gaussian window and constants.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["grey_of", "structural_similarity"]

Picture = NDArray[np.float64]

DEVIATION = 1.5
"""Of the window [pixels]."""
REACH = 5
"""Of the window to each side [pixels]."""
STEADY = (0.01**2, 0.03**2)
"""Keep quotients of dark or even places finite; values go from 0 to 1."""
GREY = (0.2126, 0.7152, 0.0722)
"""Shares of red, green and blue in luma (ITU-R BT.709)."""


def grey_of(picture: NDArray[np.floating]) -> Picture:
    """Returns the luma of a picture of screen values, shape [rows, columns, 3]."""
    grey: Picture = np.asarray(picture, np.float64) @ np.array(GREY)
    return grey


def structural_similarity(one: Picture, other: Picture) -> float:
    """Returns the mean structural similarity of grey pictures, 1 where they are the same.

    Args:
        one: Values from 0 to 1, shape [rows, columns], at least as large as the window.
        other: As large.
    """
    mean_one, mean_other = _blurred(one), _blurred(other)
    variances = _blurred(one * one) - mean_one**2 + _blurred(other * other) - mean_other**2
    covariance = _blurred(one * other) - mean_one * mean_other
    bright, varied = STEADY
    similar = (2.0 * mean_one * mean_other + bright) * (2.0 * covariance + varied)
    similar /= (mean_one**2 + mean_other**2 + bright) * (variances + varied)
    return float(similar.mean())


def _blurred(picture: Picture) -> Picture:
    """Returns weighted means over the window, where all of it lies in the picture."""
    places = np.arange(-REACH, REACH + 1)
    weights = np.exp(-0.5 * (places / DEVIATION) ** 2)
    weights /= weights.sum()
    for axis in (0, 1):
        windows = np.lib.stride_tricks.sliding_window_view(picture, len(weights), axis)
        picture = windows @ weights
    return picture
