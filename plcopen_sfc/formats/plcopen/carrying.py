"""Where TC6 XML carries what it cannot say: our own foreign data and, in 1.01, XML comments. Reading them back.

``<data name="urn:plcopen-sfc:fields"><fields><field name="max_time">"T#5s"</field></fields></data>``: fields of the
model object that belongs to the element, each as JSON.
"""

from __future__ import annotations

import json

from lxml import etree

from plcopen_sfc.formats.plcopen.reading import Fields, ReadContext, merge
from plcopen_sfc.formats.xml.extension_data import COMMENT_MARK
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.drawing import StepActionKind

FIELDS_DATA = "urn:plcopen-sfc:fields"
STEP_ACTION_FIELD = "step_action"
"""At an association: the step action that it stands for."""
STEP_ACTION_QUALIFIERS = {
    StepActionKind.ENTRY: Qualifier.P1,
    StepActionKind.MAIN: Qualifier.N,
    StepActionKind.EXIT: Qualifier.P0,
}
"""The qualifier that does what a step action does (IEC 61131-3 ed. 3, table 59)."""
APPLICATION_FIELD = "application"
"""At a configuration: it only holds an application."""
SCHEDULE_FIELD = "schedule"
"""At a task: when it runs as the source says it, and what was written for that."""
INSTANCE_FIELD = "instance"
"""At a program instance: its name and type in the source, and what was written for them."""
SHARED_FIELD = "shared_ids"
"""At a transition below a convergence of steps: the ids of the transitions that it stands for."""


def read_fields(ctx: ReadContext, data: etree._Element, fields: Fields, owner: str) -> bool:
    """Put our own data back into the fields of the element's object."""
    found: Fields = {}
    for entry in data.iterfind(f"{{{FIELDS_DATA}}}fields/{{{FIELDS_DATA}}}field"):
        try:
            found[entry.get("name", "")] = json.loads(entry.text or "")
        except json.JSONDecodeError as error:
            ctx.warn("XML208", f"carried field {entry.get('name')!r} is damaged: {error}", entry, owner)
            return False
    merge(fields, found)
    return True


def read_comment(ctx: ReadContext, comment: etree._Element, fields: Fields, owner: str) -> bool:
    """Put fields back that stand in an XML comment; False where the comment is not one of ours."""
    text = comment.text or ""
    if not isinstance(comment, etree._Comment) or not text.startswith(COMMENT_MARK):
        return False
    try:
        merge(fields, json.loads(text.removeprefix(COMMENT_MARK)))
    except (ValueError, AttributeError) as error:
        ctx.warn("XML208", f"carried fields are damaged: {error}", comment, owner)
        return False
    return True
