"""What can be read of a path: files and folders, and no devices, pipes or sockets."""

from __future__ import annotations

import stat
from pathlib import Path

from palpate.base.errors import OptionError

__all__ = ["check_plain"]


def check_plain(path: Path) -> None:
    """Refuses what is there and is neither a file nor a folder: reading it may never end.

    Raises:
        OptionError: It is a device, a pipe or a socket.
    """
    try:
        mode = path.stat().st_mode
    except OSError:
        # whoever opens it says why it cannot be
        return
    except ValueError:
        raise OptionError(f"{str(path)!r} is no path; allowed: that of a file or folder") from None
    if not (stat.S_ISREG(mode) or stat.S_ISDIR(mode)):
        raise OptionError(f"{path} is a device, a pipe or a socket; allowed: a file or a folder")
