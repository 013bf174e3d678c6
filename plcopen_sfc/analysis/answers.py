"""What an analysis can say: yes, no, or that it does not know."""

from __future__ import annotations

from enum import Enum


class Answer(Enum):
    """Yes, no, or unknown. Only YES is true where Python asks for a truth value."""

    YES = "yes"
    NO = "no"
    UNKNOWN = "unknown"

    def __bool__(self) -> bool:
        return self is Answer.YES

    def __str__(self) -> str:
        return self.value
