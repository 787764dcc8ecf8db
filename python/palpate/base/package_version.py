"""The version of Palpate."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version

__all__ = ["package_version"]


def package_version() -> str:
    """Returns the version of the installed package."""
    try:
        return version("palpate")
    except PackageNotFoundError:
        return "unknown"
