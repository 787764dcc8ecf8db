"""The process of one case: takes its request on stdin, and leaves done.json or failed.json.

It ends with whoever started it: their end of stdin closes then. It is started while another case
runs, and imports meanwhile what a case needs; the process that reads files starts beside that.
"""

from __future__ import annotations

import json
import os
import sys
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from threading import Thread

from palpate.base.errors import PalpateError
from palpate.base.full_disk import told_of
from palpate.base.reader_process import held, warm

__all__ = ["main"]

LIKELY = (
    # of the small picture: Pillow imports all of them to write one
    *(f"PIL.{kind}ImagePlugin" for kind in ("Bmp", "Gif", "Jpeg", "Ppm", "Png")),
    "palpate.segmentation.segment_steps",
)
"""Modules that most cases need, and that are imported where they are needed."""


def main() -> None:
    """Runs the case that stdin names."""
    # beside it another case runs, and of what readers import in advance a scan needs one in three
    warm(idle=False)
    from palpate.cohort.case_work import work

    for module in LIKELY:
        import_module(module)
    line = sys.stdin.buffer.readline()
    if not line:
        return
    Thread(target=_end_with_parent, daemon=True).start()
    request = json.loads(line)
    part = Path(request["part"])
    try:
        _limit(request["memory"])
        told, name = work(request, part), "done.json"
    except MemoryError:
        reason = "not enough memory; a higher memory limit gives it more"
        told, name = {"reason": reason}, "failed.json"
    except (PalpateError, OSError) as error:
        told, name = {"reason": told_of(error)}, "failed.json"
    except Exception as error:  # noqa: BLE001  # a case that fails is told, whatever it is
        told, name = {"reason": f"{type(error).__name__}: {error}"}, "failed.json"
    except BaseException as error:  # noqa: BLE001  # the engine gave up
        reason = f"the engine gave up ({error}); where memory is limited, a higher limit may help"
        told, name = {"reason": reason}, "failed.json"
    text = json.dumps(told, indent=1, ensure_ascii=False) + "\n"
    (part / name).write_text(text, "utf-8")
    # threads of libraries are not waited for
    os._exit(0)


def _limit(memory: int | None) -> None:
    """Sets how much memory this process may take for data [bytes]; Linux alone counts that.

    Raises:
        MemoryError: It holds as much already; what is freed again could still take it far.
    """
    if memory is not None and sys.platform == "linux":
        import resource

        resource.setrlimit(resource.RLIMIT_DATA, (memory, memory))
        if held() >= memory:
            raise MemoryError


def _end_with_parent() -> None:
    with suppress(OSError):
        sys.stdin.buffer.read()
    os._exit(1)


if __name__ == "__main__":
    main()
