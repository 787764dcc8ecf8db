"""The page: segments of the second scan are carried to the first one."""

from __future__ import annotations

from pathlib import Path

import pytest
from browser import browser, palpate

pytestmark = pytest.mark.browser


def test_segments_of_the_second_scan_come_to_the_first(data_folder: Path) -> None:
    folder = data_folder / "elastix_lung_pair"
    first, second = folder / "3DCT_lung_baseline.mha", folder / "3DCT_lung_followup.mha"
    with palpate("open", first, "--with", second) as command, browser() as page:
        page.do("open", url=command.url, width=1280, height=860)
        page.do("clickText", text="Second scan")
        mask = folder / "3DCT_lung_followup_mask.mha"
        page.do("give", testid="second-segments-file", path=str(mask))
        page.shows("segment-2", "/label 1/.test(text)")
