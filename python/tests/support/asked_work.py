"""Work on segments that is done for a page, without a server."""

from __future__ import annotations

import asyncio
from typing import Any

from palpate import protocol
from palpate.server.messages.segment_list import SegmentList
from palpate.server.messages.segment_work import SegmentWork
from palpate.session.session import Session, SessionOptions
from palpate.volumes.scene import Scene
from running_server import PATIENCE


def asked_of(
    scene: Scene, *asked: protocol.FromPage, also: Any = lambda _work: None
) -> tuple[list[protocol.ToPage], list[int]]:
    """Has work done; returns what was told, and the voxels of the first segment after each step."""
    told: list[protocol.ToPage] = []
    voxels: list[int] = []
    with Session(scene, options=SessionOptions(real_time=False)) as session:

        async def ask() -> None:
            work = SegmentWork(session, SegmentList(session), told.append)
            runner = asyncio.create_task(work.run())
            for each in asked:
                work.ask(each)  # type: ignore[arg-type]
                also(work)
                while work.is_busy:
                    await asyncio.sleep(0.001)
                voxels.append(session.segment(1).voxel_count)
            runner.cancel()
            session.undo()
            voxels.append(session.segment(1).voxel_count)

        asyncio.run(asyncio.wait_for(ask(), PATIENCE))
    return told, voxels
