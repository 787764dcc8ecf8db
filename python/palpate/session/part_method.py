"""Methods of a session that one of its parts carries out.

``cut = PartMethod("_segments", SessionSegments.cut)`` in the class ``Session`` makes
``session.cut(…)`` call ``session._segments.cut(…)``. Signature and documentation are those of the
part's method, and stand in one place only.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Concatenate, Generic, ParamSpec, TypeVar, overload

__all__ = ["PartMethod"]

Part = TypeVar("Part")
Given = ParamSpec("Given")
Result = TypeVar("Result")


class PartMethod(Generic[Part, Given, Result]):
    """A method that an attribute of the session, one of its parts, carries out."""

    def __init__(self, part: str, method: Callable[Concatenate[Part, Given], Result]) -> None:
        """Takes the name of the attribute, and the method of its class."""
        self.part = part
        self.__wrapped__ = method
        self.__doc__ = method.__doc__

    @overload
    def __get__(self, session: None, owner: type) -> Callable[Concatenate[Part, Given], Result]: ...
    @overload
    def __get__(self, session: object, owner: type) -> Callable[Given, Result]: ...
    def __get__(
        self, session: object, owner: type
    ) -> Callable[Concatenate[Part, Given], Result] | Callable[Given, Result]:
        """Returns the method of the session's part; of the class, the plain function."""
        if session is None:
            return self.__wrapped__
        bound: Callable[Given, Result] = getattr(
            getattr(session, self.part), self.__wrapped__.__name__
        )
        return bound
