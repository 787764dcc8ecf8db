"""Statistics of segments for a page: measured as edits have left them, and ended when it leaves."""

from __future__ import annotations

import csv
import json
from typing import Any

from palpate.server.messages.segment_list import SegmentList
from palpate.server.segment_statistics import statistics_job


def table_of(server: Any) -> dict[str, Any]:
    answer = server.ask("POST", "/api/statistics")
    lines = [json.loads(line) for line in answer.text.splitlines()]
    assert lines[-1] == {"kind": "done"}
    table: dict[str, Any]
    (table,) = (line for line in lines if line["kind"] == "statistics")
    return table


def test_a_page_gets_the_table_of_segments_as_they_are_now(server: Any) -> None:
    before = table_of(server)
    assert before["cells"][0][:4] == ["segment", "volume", "voxels", "mean [HU]"]
    (row,) = csv.DictReader(before["csv"].splitlines())
    assert float(row["mean_HU"]) == 100.0
    assert int(row["voxels"]) == server.session.segment(1).voxel_count
    server.session.fill_box(1, low=(0, 0, 0), high=(41, 41, 20), solid=False)
    (row,) = csv.DictReader(table_of(server)["csv"].splitlines())
    assert int(row["voxels"]) == server.session.segment(1).voxel_count < int(before["cells"][1][2])


def test_a_page_is_told_that_a_moved_segment_is_measured_where_the_scan_has_it(server: Any) -> None:
    pose = [1, 0, 0, 9, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
    with server.page() as page:
        page.send({"type": "move_segment", "id": 1, "pose": pose, "goes_on": False})
        page.receive("segments", until=lambda m: m["segments"][0]["pose"] is not None)
    (note,) = table_of(server)["notes"]
    assert note.endswith("was moved: it is taken where the scan has it")


def test_who_leaves_ends_the_work(server: Any) -> None:
    segments = SegmentList(server.session)
    said: list[Any] = []
    job = statistics_job(segments, lambda: server.session.scene.volume.array)
    job._cancelled.set()
    job._run(said.append)
    assert said == [{"kind": "failed", "reason": "it was cancelled"}, None]
