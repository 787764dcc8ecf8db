"""The files of the repository that people write, as the checks see them."""

from __future__ import annotations

import subprocess
from pathlib import Path

ROOT = Path(__file__).parent.parent


def repository_files(root: Path = ROOT) -> list[Path]:
    """Returns all files that git holds or would add, in order."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=root,
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    files = [root / name for name in sorted(set(listed.split("\0"))) if name]
    return [file for file in files if file.is_file()]
