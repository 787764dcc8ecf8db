"""The second scan as pages are told of it."""

from __future__ import annotations

from palpate import protocol
from palpate.second_scan import SecondScan
from palpate.server_hello import scan_of

__all__ = ["second_message"]


def second_message(second: SecondScan | None, *, version: int) -> protocol.SecondScan:
    """Returns what pages are told; another ``version`` has other values."""
    if second is None:
        return protocol.SecondScan(scan=None, second_from_first=[], version=version)
    return protocol.SecondScan(
        scan=scan_of(second.volume),
        second_from_first=[float(number) for number in second.second_from_first.ravel()],
        version=version,
    )
