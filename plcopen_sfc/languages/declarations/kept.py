"""What a declaration says that the model has no field for: carried at the object, under a name of ours.

``<data name="urn:plcopen-sfc:declaration"><declaration><edge>R_EDGE</edge></declaration></data>``: texts by name, in
XML as all foreign data.
"""

from __future__ import annotations

import re
from xml.sax.saxutils import escape, unescape

from plcopen_sfc.model.base import Carried, ForeignData

KEPT_DATA = "urn:plcopen-sfc:declaration"
_ENTRY = re.compile(r"<(?P<name>\w+)>(?P<text>[^<]*)</(?P=name)>")


def keep(texts: dict[str, str]) -> Carried | None:
    """Foreign data that holds `texts`; None if there are none."""
    if not texts:
        return None
    entries = "".join(f"<{name}>{escape(text)}</{name}>" for name, text in texts.items())
    content = f'<declaration xmlns="{KEPT_DATA}">{entries}</declaration>'
    return Carried(data=[ForeignData(name=KEPT_DATA, content=content)])


def kept(carried: Carried | None) -> dict[str, str]:
    """The texts that `keep` put there."""
    if carried is None:
        return {}
    entries = (entry for data in carried.data if data.name == KEPT_DATA for entry in _ENTRY.finditer(data.content))
    return {entry["name"]: unescape(entry["text"]) for entry in entries}
