"""Put an edit of the model into the source text, and change nothing else.

A three-way merge. `before` is the tree that our writer makes of the model as it was loaded, `after` the tree that the
same writer makes of the edited model; their difference is the edit. The source text corresponds to `before` element by
element, but says more (comments, unknown attributes and elements, its own handwriting). So: walk down all three
together, skip what is equal in `before` and `after`, and where they differ note which characters of the source are to
be replaced. What the source has and `before` lacks is never touched.

The work is in `merge`; `tokens` knows where things stand in the source, `align` which child is which, `layout` and
`fragments` how new lines look, `texts` how text changes in place, `moves` what was only moved.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from plcopen_sfc.errors import SfcError
from plcopen_sfc.formats.xml.align import KeyFunction, default_keys
from plcopen_sfc.formats.xml.escaping import encode_text
from plcopen_sfc.formats.xml.merge import Merge
from plcopen_sfc.formats.xml.source import decode, parse
from plcopen_sfc.formats.xml.tokens import PatchError, SourceTree

if TYPE_CHECKING:
    from lxml import etree

__all__ = ["PatchError", "patch"]


def patch(source: bytes, before: etree._Element, after: etree._Element, *, keys: KeyFunction = default_keys) -> bytes:
    """`source` with the difference from `before` to `after` applied; byte for byte the same where they are equal.

    `keys` names the identifying attributes of an element, strongest first. Raises `PatchError` if the result would not
    be well-formed or `before` does not describe `source`, and `EncodingError` if a new name cannot be written in the
    encoding of the file.
    """
    if before is after:
        return source
    text, encoding = decode(source)
    if encoding.encode(text) != source:
        raise PatchError(f"the source text does not come back the same from {encoding.codec}")
    try:
        edited = Merge(SourceTree(text), encoding.codec, before, after, keys=keys).run()
    except ValueError as error:
        if isinstance(error, SfcError):
            raise
        raise PatchError(f"the edits of the source text contradict each other: {error}") from error
    if edited == text:
        return source
    result = encoding.bom + encode_text(edited, encoding.codec)
    try:
        parse(result)
    except SfcError as error:
        raise PatchError(f"the edited file would be damaged: {error.message}", location=error.location) from error
    return result
