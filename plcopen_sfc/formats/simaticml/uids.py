"""The ``UId`` of the elements of a program: running numbers that tie its elements together, and mean nothing else.

We number programs as TIA Portal does. Where a file does otherwise, its numbers are kept in short form beside the model,
so that a program that nobody edited keeps them; an edited one of another length is numbered anew.
"""

from __future__ import annotations

from typing import Any

from plcopen_sfc.formats.simaticml.reading import XmlNode, children, local

UID = "UId"
FIRST = 21
"""The first number that TIA Portal gives."""
NUMBERS = "UId numbers"
"""Carried attribute: the numbers of the file, in the order in which we give ours."""


def shortened(numbers: list[str], usual: list[str]) -> str:
    """Numbers in short form: ``21-40 42``; "" where they are the `usual` ones."""
    if numbers == usual:
        return ""
    runs: list[list[int]] = []
    for text in numbers:
        number = int(text)
        if runs and number == runs[-1][1] + 1:
            runs[-1][1] = number
        else:
            runs.append([number, number])
    return " ".join(f"{first}-{last}" if last > first else str(first) for first, last in runs)


def lengthened(text: str, usual: list[str]) -> list[str]:
    """The numbers of a short form; the `usual` ones where there are not as many."""
    count = len(usual)
    found: list[str] = []
    for run in text.split():
        first, dash, last = run.partition("-")
        if not _is_number(first) or (dash and not _is_number(last)) or int(last or first) - int(first) >= count:
            return usual
        found += [str(number) for number in range(int(first), int(last or first) + 1)]
    return found if len(found) == count == len(set(found)) else usual


def are_numbers(texts: list[str]) -> bool:
    """Whether all of them are plain whole numbers, each another."""
    return all(map(_is_number, texts)) and len(set(texts)) == len(texts)


def _is_number(text: str) -> bool:
    return text.isascii() and text.isdigit() and len(text) < _LONGEST and text == str(int(text))


_LONGEST = 12


def numbers_of(root: XmlNode) -> list[str]:
    """The numbers of the elements below `root`, which must be whole numbers; rising."""
    return [str(number) for number in sorted({int(str(element.get(UID))) for element in _numbered(root)})]


def renumber(root: XmlNode, text: str) -> None:
    """Give the elements below `root`, which has the usual numbers, those of a short form.

    Operands, parts and wires of networks stand in the order of their numbers then, as in TIA Portal.
    """
    usual = numbers_of(root)
    numbers = dict(zip(usual, lengthened(text, usual), strict=True))
    for element in _numbered(root):
        element.set(UID, numbers[str(element.get(UID))])
    for group in root:
        if local(group) in ("Parts", "Wires"):
            ordered: list[Any] = sorted(children(group), key=lambda element: int(str(element.get(UID))))
            group[:] = ordered


def _numbered(root: XmlNode) -> list[XmlNode]:
    return [
        element
        for element in root.iter()
        if isinstance(element.tag, str) and element.get(UID) is not None and element is not root
    ]
