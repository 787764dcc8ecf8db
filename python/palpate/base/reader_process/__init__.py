"""Reading in a process of its own, so that a file which ends its reader ends nothing else.

A function of a module is called in a worker: a plain subprocess of this interpreter, kept warm for
the next call. It needs no ``__main__`` guard, and works in threads, notebooks and forked children.
Arguments and results are pickled; large arrays come through memory that both processes share.
"""

from __future__ import annotations

from palpate.base.reader_process.call import apart, apart_each
from palpate.base.reader_process.limits import expect, held, in_this_process, looking_at
from palpate.base.reader_process.pool import warm

__all__ = ["apart", "apart_each", "expect", "held", "in_this_process", "looking_at", "warm"]
