"""Pictures of the engine as pages read them: colours and depths of a ``DrawnPicture``."""

from __future__ import annotations

import io
import math
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

Told = dict[str, Any]


def colours_of(message: Told) -> NDArray[np.float32]:
    """Returns linear colours multiplied by opacity, and opacity, as the page's shader does."""
    columns, rows = message["size"]
    if message["coding"] == "raw":
        flat = np.frombuffer(message["colours"], "<f2").astype(np.float32)
        return flat.reshape(rows, columns, 4)
    with Image.open(io.BytesIO(message["colours"])) as image:
        shares = np.asarray(image.convert("RGB"), np.float32) / 255.0
    light, opacity = shares[:rows], shares[rows:, :, :1]
    linear = np.where(light <= 0.04045, light / 12.92, ((light + 0.055) / 1.055) ** 2.4)
    # nothing shines where nothing is
    linear = np.where(opacity < 0.5 / 255.0, 0.0, message["brightest"] * linear)
    return np.concatenate([linear, opacity], axis=2)


def depths_of(message: Told) -> NDArray[np.float64]:
    """Returns depths [mm], negative of what is seen through, infinite where nothing is."""
    columns, rows = (math.ceil(edge / message["depth_every"]) for edge in message["size"])
    if message["coding"] == "raw":
        steps = np.frombuffer(message["depths"], "<u2").reshape(rows, columns)
    else:
        planes = np.frombuffer(zlib.decompress(message["depths"]), np.uint8)
        low, high = planes.reshape(2, rows, columns).astype("<u2")
        steps = np.cumsum(low + 256 * high, axis=1, dtype="<u2")
    is_haze = steps >= 32768
    share = (steps - 32768.0 * is_haze) / 32766.0
    depths = message["nearest"] + share * (message["farthest"] - message["nearest"])
    return np.where(steps == 65535, np.inf, np.where(is_haze, -depths, depths))
