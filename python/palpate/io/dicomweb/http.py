"""Requests to a DICOMweb service: bounded, ended when the work ends, and told where they fail.

No sentence here repeats what a server says: it may name patients.
"""

from __future__ import annotations

import logging
import warnings
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from threading import Event, Lock, local
from typing import TYPE_CHECKING, Any, TypeVar

from palpate.base.damaged_file import BROKEN
from palpate.base.errors import DicomWebError, PalpateError
from palpate.io.dicomweb.address import WebAddress

if TYPE_CHECKING:
    from dicomweb_client.web import DICOMwebClient
    from urllib3.response import BaseHTTPResponse

__all__ = ["Budget", "asking", "client_of", "in_parallel", "pool_of"]

PATIENCE = (10.0, 120.0)
"""Until a server takes the connection, and between two pieces of an answer [s]."""
MOST_REDIRECTS = 5
TRIES = 3
"""Where a server is busy."""
MOST_THREADS = 4
BUSY = (429, 503)
SERVICE = "allowed: the address of a DICOMweb service, such as http://127.0.0.1:8042/dicom-web"


class Budget:
    """How much may come from a server in all; shared by all who ask it."""

    def __init__(self, most: int) -> None:
        """Allows so many bytes."""
        self._most = most
        self._taken = 0
        self._lock = Lock()
        self._ended = Event()

    @property
    def taken(self) -> int:
        """Bytes that have come."""
        return self._taken

    def end(self) -> None:
        """Has whatever still comes be left alone."""
        self._ended.set()

    def take(self, count: int) -> None:
        """Counts bytes.

        Raises:
            DicomWebError: They are too many, or nobody waits for them any more.
        """
        if self._ended.is_set():
            raise DicomWebError("the work has ended")
        with self._lock:
            self._taken += count
        if self._taken > self._most:
            raise DicomWebError(
                f"the server sends more than {self._most / 2**20:.0f} MiB; allowed: fewer or "
                "smaller files"
            )


class _Counted:
    """The body of an answer: every piece of it is taken from a budget."""

    def __init__(self, body: BaseHTTPResponse, budget: Budget) -> None:
        self._body = body
        self._budget = budget

    def read(self, count: int) -> bytes:
        """Returns the next bytes; none at the end."""
        piece = self._body.read(count, decode_content=True)
        self._budget.take(len(piece))
        return piece

    def close(self) -> None:
        """Closes the connection."""
        self._body.close()

    def release_conn(self) -> None:
        """Gives the connection back."""
        self._body.release_conn()


@contextmanager
def client_of(address: WebAddress, budget: Budget) -> Iterator[DICOMwebClient]:
    """Gives a client for one thread; leaving closes its connections."""
    from dicomweb_client.web import DICOMwebClient
    from requests import PreparedRequest, Response, Session
    from requests.adapters import HTTPAdapter
    from urllib3.util import Retry

    class Bounded(HTTPAdapter):
        def send(self, request: PreparedRequest, *_: Any, **options: Any) -> Response:  # noqa: ANN401  # as the library has it
            # the client names the host without its port
            request.headers.pop("Host", None)
            # one that was not read to its end keeps its connection even when the session closes
            latest.close()
            answer = super().send(request, **(options | {"stream": True, "timeout": PATIENCE}))
            answer.raw = _Counted(answer.raw, budget)
            latest.callback(answer.raw.close)
            return answer

    session, latest = Session(), ExitStack()
    session.max_redirects = MOST_REDIRECTS
    # no proxy leads back to this machine
    session.trust_env = not address.local
    session.auth = address.login
    retries = Retry(
        TRIES - 1,
        connect=0,
        # a server that kept a connection open may close it just then
        read=1,
        status_forcelist=BUSY,
        backoff_factor=0.5,
        raise_on_status=False,
        respect_retry_after_header=False,
    )
    for scheme in ("http://", "https://"):
        session.mount(scheme, Bounded(max_retries=retries))
    client = DICOMwebClient(address.service, session=session)
    # it would try again whatever fails, for half a minute
    client.set_http_retry_params(retry=False)
    with session, latest:
        yield client


@contextmanager
def _trouble_told(address: WebAddress) -> Iterator[None]:
    """Tells what requests or their answers fail with as one sentence; for one thread at a time.

    Raises:
        DicomWebError: The server is not there, refuses, or does not speak DICOMweb.
    """
    import requests
    import urllib3
    from pydicom.errors import BytesLengthException, InvalidDicomError

    # it logs what servers warn of
    logging.getLogger("dicomweb_client").setLevel(logging.CRITICAL)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    except (PalpateError, MemoryError):
        raise
    except requests.HTTPError as error:
        status = 0 if error.response is None else error.response.status_code
        raise DicomWebError(_refused(address, status)) from None
    except requests.exceptions.SSLError:
        raise DicomWebError(
            f"the certificate of {address} is not valid here; allowed: one that this machine "
            "trusts (REQUESTS_CA_BUNDLE names others)"
        ) from None
    except requests.Timeout:
        raise DicomWebError(
            f"the server at {address} does not answer in time; allowed: a server that does"
        ) from None
    except requests.ConnectionError:
        raise DicomWebError(f"no server answers at {address}; {SERVICE}") from None
    except (
        *BROKEN, requests.RequestException, urllib3.exceptions.HTTPError, BytesLengthException,
        InvalidDicomError,
    ):  # fmt: skip
        raise DicomWebError(
            f"the server at {address} answers, but not as DICOMweb; {SERVICE}"
        ) from None


def _refused(address: WebAddress, status: int) -> str:
    if status in {401, 403, 407}:
        given = "no name" if address.login is None else "this name and password"
        return (
            f"the server at {address} refuses access with {given} ({status}); allowed: "
            "https://name:password@host/…, or a line in ~/.netrc"
        )
    if status in {404, 405, 410, 501}:
        return f"the server at {address} has no such resource ({status}); {SERVICE}"
    if status >= 500:
        return f"the server at {address} fails by itself ({status}); allowed: a server that works"
    return f"the server at {address} refuses what it was asked ({status}); {SERVICE}"


@contextmanager
def asking(address: WebAddress, most: int) -> Iterator[Budget]:
    """Gives a budget of bytes for as long as something is asked; leaving ends what still comes.

    Raises:
        DicomWebError: As the server fails.
    """
    budget = Budget(most)
    try:
        with _trouble_told(address):
            yield budget
    finally:
        budget.end()


Wanted = TypeVar("Wanted")
Made = TypeVar("Made")


@contextmanager
def pool_of(
    work: Callable[[DICOMwebClient, Wanted], Made],
    wanted: Sequence[Wanted],
    asked: tuple[WebAddress, Budget],
) -> Iterator[list[Future[Made]]]:
    """Works on all that is wanted, several at a time, each thread with a client of its own."""
    own = local()

    def worked(one: Wanted) -> Made:
        if not hasattr(own, "client"):
            own.client = clients.enter_context(client_of(*asked))
        return work(own.client, one)

    with ExitStack() as clients, ThreadPoolExecutor(min(MOST_THREADS, max(1, len(wanted)))) as pool:
        try:
            yield [pool.submit(worked, one) for one in wanted]
        except BaseException:
            asked[1].end()
            raise
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def in_parallel(
    work: Callable[[DICOMwebClient, Wanted], Made],
    wanted: Sequence[Wanted],
    asked: tuple[WebAddress, Budget],
) -> Iterator[Made]:
    """Yields what is made of all that is wanted, in its order."""
    with pool_of(work, wanted, asked) as futures:
        for future in futures:
            yield future.result()
