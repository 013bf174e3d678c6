"""Reading objects of a document when somebody first looks at them. See docs/decisions/0003."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar
from weakref import WeakValueDictionary

from lxml import etree

from plcopen_sfc.formats.provenance import read_later, remember_body
from plcopen_sfc.formats.simaticml.objects_reader import (
    DATA_BLOCKS,
    DATA_TYPE,
    POUS,
    read_data_block,
    read_data_type,
    read_pou,
    read_tag_table,
)
from plcopen_sfc.formats.simaticml.reading import (
    Fields,
    ReadContext,
    carry_attribute,
    child_named,
    local,
    plain_text,
    read_model,
    whole_number,
)
from plcopen_sfc.formats.xml.extension_data import Markup, exchange
from plcopen_sfc.formats.xml.xml_parsing import SourceLines, parse
from plcopen_sfc.model.body import SfcBody
from plcopen_sfc.model.pou import DataBlock, Pou
from plcopen_sfc.model.project import TagTable
from plcopen_sfc.model.project_object import ProjectObject
from plcopen_sfc.model.types import DataTypeDeclaration

T = TypeVar("T", bound=ProjectObject)


class LateDocument:
    """A document whose objects are not read yet.

    It keeps the bytes, not the tree, which takes many times their memory: a folder may have thousands of documents.
    Only the document that was loaded last has its tree still, for whoever loads one and looks at it. When the first
    object of another is read, its bytes are parsed again; the tree stays until the last object is read.
    """

    def __init__(self, root: etree._Element, data: bytes, ctx: ReadContext) -> None:
        self._data = data
        self._ctx = ctx
        self._root: etree._Element | None = root
        self._waiting = 0
        self._begun = False
        last = _LOADED_LAST.get("document")
        if last is not None:
            last._forget()
        _LOADED_LAST["document"] = self

    def _forget(self) -> None:
        """Give the memory of the tree back, if nobody has begun to read."""
        if not self._begun:
            self._root = None

    def object(self, element: etree._Element, place: int, *, keep_id: bool) -> ProjectObject:
        """The object at `element`, which is child `place` of the root, unread."""
        kind = local(element)
        if kind in POUS:
            return self._later(Pou, read_pou, element, place, keep_id=keep_id)
        if kind in DATA_BLOCKS:
            return self._later(DataBlock, read_data_block, element, place, keep_id=keep_id)
        if kind == DATA_TYPE:
            return self._later(DataTypeDeclaration, read_data_type, element, place, keep_id=keep_id)
        return self._later(TagTable, read_tag_table, element, place, keep_id=keep_id)

    def _later(
        self,
        model: type[T],
        reader: Callable[[ReadContext, etree._Element], Fields],
        element: etree._Element,
        place: int,
        *,
        keep_id: bool,
    ) -> T:
        holder = child_named(element, "AttributeList")
        values = {local(child): child for child in reversed(holder)} if holder is not None else {}
        name = values.get("Name")
        eager: Fields = {"name": (name.text or "") if name is not None else ""}
        plain = next(element.iterchildren(etree.Comment), None) is None  # a comment of ours may say anything
        if plain:
            eager["folder"] = None
        if plain and model in (Pou, DataBlock):
            eager["number"] = whole_number(plain_text(values.get("Number")))
            eager["kind"] = (POUS | DATA_BLOCKS)[local(element)]
        self._waiting += 1
        waiting = True

        def fields_of(ctx: ReadContext, found: etree._Element) -> Fields:
            fields = reader(ctx, found)
            if keep_id:
                carry_attribute(fields, "ID", found.get("ID", ""))
            return fields

        def read() -> T:
            nonlocal waiting
            found = self._tree()[place]
            thing = read_model(self._context(), found, model, fields_of)
            if not self._ctx.of_tia:
                exchange(thing, Markup.SIMATICML, Markup.TC6)
            if isinstance(thing, Pou):
                for name, _, body in thing.named_bodies():
                    if isinstance(body, SfcBody):
                        remember_body(body, name, self._data)
            if waiting:
                waiting = False
                self._done()
            return thing

        return read_later(model, eager, read)

    def _tree(self) -> etree._Element:
        root = self._root
        if root is None:
            root = parse(self._data, file=self._ctx.file)
        if not self._begun or self._ctx.lines is None:
            self._ctx.lines = SourceLines(root, self._data)
        self._root, self._begun = root, True
        return root

    def _context(self) -> ReadContext:
        """A context of its own for each object; what is said about the document is in one list."""
        ctx = ReadContext(self._ctx.version, file=self._ctx.file, lines=self._ctx.lines)
        ctx.of_tia, ctx.edited_copies = self._ctx.of_tia, self._ctx.edited_copies
        ctx.schemas, ctx.diagnostics = self._ctx.schemas, self._ctx.diagnostics
        return ctx

    def _done(self) -> None:
        self._waiting -= 1
        if not self._waiting:
            self._root = self._ctx.lines = None


_LOADED_LAST: WeakValueDictionary[str, LateDocument] = WeakValueDictionary()
"""The document that was loaded last."""
