"""The dialects of structured text that the library reads and writes."""

from __future__ import annotations

from enum import StrEnum


class Dialect(StrEnum):
    """A dialect of structured text.

    IEC: IEC 61131-3 ed. 3. CODESYS: CODESYS V3 and V2.3. TWINCAT: TwinCAT 3, which is CODESYS V3 in its language. SCL:
    Siemens SCL of TIA Portal and STEP 7 (names of locals with ``#``, of globals in quotes).
    """

    IEC = "iec"
    CODESYS = "codesys"
    TWINCAT = "twincat"
    SCL = "scl"

    @property
    def label(self) -> str:
        """The name for people, such as ``CODESYS ST``."""
        return {"iec": "IEC 61131-3 ST", "codesys": "CODESYS ST", "twincat": "TwinCAT ST", "scl": "SCL"}[self]


COUNTING_BYTES = frozenset({Dialect.SCL, Dialect.TWINCAT})
"""Dialects whose tools give words the number of their first byte: ``%MW2`` is bytes 2 and 3, in others 4 and 5."""


def address_dialect(format: str, dialect: Dialect, product: str = "") -> Dialect:
    """Return the dialect that addresses have in files of a format, whose texts are in `dialect`.

    `product`: what made a file; TwinCAT exports the XML of CODESYS. Evidence: help of TwinCAT 3, "Addresses".
    """
    of_twincat = format == "twincat" or (format == "codesys" and product.casefold().startswith("twincat"))
    return Dialect.TWINCAT if of_twincat and dialect is not Dialect.SCL else dialect


STRING_LENGTHS = {Dialect.SCL: "254", Dialect.CODESYS: "80"}
"""Length of a string, in characters, whose declaration gives none; IEC 61131-3 leaves it to the tool."""
