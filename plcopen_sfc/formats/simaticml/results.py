"""Results of functions: in other tools they have the name of the function, in SimaticML that of a member.

The member ``Ret_Val`` of the section ``Return`` has the type of the result. A function of another tool gets both,
marked as added: when the file is read the result is that of the model again. That texts of the function call it
``#Ret_Val`` too is not confirmed by an export; the name of the member is what they can refer to.
"""

from __future__ import annotations

from typing import Any

from lxml import etree

from plcopen_sfc.formats.simaticml.added import keep_added
from plcopen_sfc.formats.simaticml.reading import Fields
from plcopen_sfc.formats.simaticml.types import write_type
from plcopen_sfc.formats.simaticml.writing import sub
from plcopen_sfc.languages.s7_results import OPERANDS, RESULT, rename_local, renamed_local
from plcopen_sfc.model.body import Body, FbdBody, LdBody, StBody
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.types import DataType

RETURN = "Return"


def write_result(sections: etree._Element, type_: DataType) -> None:
    """Write the section with the result of a function."""
    section = sub(sections, "Section", {"Name": RETURN})
    keep_added(section)
    keep_added(sub(section, "Member", {"Name": RESULT, "Datatype": write_type(type_)}))


def bodies_with_result(pou: Pou) -> list[Body]:
    """The bodies of a block; where it is a function with a result, that has the name of SimaticML in their texts."""
    if pou.interface is None or pou.interface.return_type is None:
        return pou.bodies
    return [_with_result(body, pou.name) for body in pou.bodies]


def _with_result(body: Body, name: str) -> Body:
    body = body.model_copy(deep=True) if isinstance(body, StBody | FbdBody | LdBody) else body
    rename_local(body, name, RESULT)
    return body


def name_result(bodies: list[Any], name: str) -> None:
    """Give the result its name in the bodies of a function that were read."""
    for body in (body for body in bodies if isinstance(body, dict)):
        texts: list[tuple[Fields, str]] = [(body, "text")] if body.get("language") == "ST" else []
        texts += [(node, f) for network in body.get("networks", []) for node in network["nodes"] for f in OPERANDS]
        for holder, field in texts:
            if isinstance(holder.get(field), str):
                holder[field] = renamed_local(holder[field], RESULT, name)
