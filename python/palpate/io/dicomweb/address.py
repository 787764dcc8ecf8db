"""The address of a DICOMweb service, as a person gives it: where it is, and what of it is meant.

    http://127.0.0.1:8042/dicom-web
    https://name:password@host/dicom-web/studies/1.2.3/series/1.2.3.4
    https://host/dicom-web/studies?PatientID=12345

Source: DICOM PS3.18, 10.1.2 (resources) and 8.3.4 (query parameters).
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from ipaddress import ip_address
from urllib.parse import SplitResult, parse_qsl, unquote, urlsplit

from palpate.base.errors import OptionError

__all__ = ["UID", "WebAddress", "is_web_address"]

UID = r"[0-9.]{1,64}"
"""A UID, as far as it matters that it leads nowhere else (PS3.5, 9.1)."""
RESOURCE = re.compile(
    rf"(?P<service>.*?)(/studies(/(?P<study>{UID})(/series(/(?P<series>{UID}))?)?)?)?/*"
)
ALLOWED = "allowed: that of a DICOMweb service, such as http://127.0.0.1:8042/dicom-web"


def is_web_address(given: str) -> bool:
    """Returns whether a text is a web address, and not a path."""
    return given.strip().lower().startswith(("http://", "https://"))


@dataclass(frozen=True)
class WebAddress:
    """Address of a DICOMweb service, and of a study, series or search in it."""

    service: str
    """Address of the service without name, password and search, which can be displayed."""
    local: bool
    """Whether the service is on this machine."""
    login: tuple[str, str] | None = field(default=None, repr=False)
    """User name and password."""
    study: str | None = None
    """StudyInstanceUID."""
    series: str | None = None
    """SeriesInstanceUID."""
    filters: tuple[tuple[str, str], ...] = field(default=(), repr=False)
    """DICOM keywords or tags, and the values to search for; they may identify a patient."""

    @classmethod
    def of(cls, given: str, *, study: str | None = None, series: str | None = None) -> WebAddress:
        """Parses an address; ``study`` and ``series`` take precedence over those in it.

        Raises:
            OptionError: It is not an address, or a UID is not valid.
        """
        for uid in (study, series):
            if uid is not None and not re.fullmatch(UID, uid):
                raise OptionError(f"UID {uid!r} given; allowed: digits and dots, at most 64")
        try:
            parts = urlsplit(given.strip())
            host, port = parts.hostname, parts.port
        except ValueError:
            raise OptionError(f"the address given cannot be read; {ALLOWED}") from None
        if parts.scheme not in {"http", "https"} or not host:
            raise OptionError(f"address {_shown(parts)!r} given; {ALLOWED}")
        found = RESOURCE.fullmatch(parts.path)
        place = (f"[{host}]" if ":" in host else host) + ("" if port is None else f":{port}")
        named = {} if found is None else found.groupdict()
        return cls(
            service=f"{parts.scheme}://{place}{named.get('service') or ''}",
            local=_is_local(host),
            login=_login(parts),
            study=study or named.get("study"),
            series=series or named.get("series"),
            filters=tuple(parse_qsl(parts.query)),
        )

    def __str__(self) -> str:
        return self.service


def _shown(parts: SplitResult) -> str:
    """Returns an address without its secrets."""
    return f"{parts.scheme}://{parts.netloc.rpartition('@')[2]}{parts.path}"


def _login(parts: SplitResult) -> tuple[str, str] | None:
    if parts.username is None:
        return None
    return unquote(parts.username), unquote(parts.password or "")


def _is_local(host: str) -> bool:
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"
