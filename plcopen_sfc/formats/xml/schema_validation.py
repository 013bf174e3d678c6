"""Validation against the package's XML schemas: libxml2 decides, `schema_explanation` finds the reason.

The schemas are in `schemas/` of a source checkout, in `plcopen_sfc/schemas/` of an installation.
"""

from __future__ import annotations

import re
import threading
from collections.abc import Callable, Iterator
from functools import cache
from importlib import resources
from itertools import islice
from pathlib import Path

from lxml import etree

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import FileAccessError, Location
from plcopen_sfc.formats.xml.xml_parsing import SourceLines
from plcopen_sfc.grouping import grouped


@cache
def schema_path(name: str) -> Path:
    """Return the file of the schema `name` (``plcopen-2.01``).

    Raises `FileAccessError` where the package was installed without its schemas.
    """
    package = resources.files("plcopen_sfc")
    for folder in (package / "schemas", Path(str(package)).parent / "schemas"):
        path = Path(str(folder)) / f"{name}.xsd"
        if path.is_file():
            return path
    raise FileAccessError(
        f"the schema {name}.xsd is missing from this installation of plcopen_sfc",
        hint="Install the package again, unpacked: libxml2 cannot read schemas inside an archive.",
    )


MAX_FINDINGS = 100
"""So many findings are reported for one file; who repairs these will run the check again."""


Judge = Callable[[etree._Element], Severity]
"""Severity of a violation at an element."""


_KEYS = ("localId", "name", "Name", "guid", "alias", "instancePathAndName", "member", "formalParameter")
_per_thread = threading.local()


def _validator(name: str) -> etree.XMLSchema:
    """Return the compiled schema. One for each thread, because a validator keeps the errors of its last run."""
    compiled: dict[str, etree.XMLSchema] = _per_thread.__dict__.setdefault("compiled", {})
    if name not in compiled:
        compiled[name] = etree.XMLSchema(etree.parse(schema_path(name), etree.XMLParser(no_network=True)))
    return compiled[name]


def is_valid(root: etree._Element, schema: str) -> bool:
    """True if the document of `root` is valid by the schema of this name, by libxml2's judgement."""
    return _validator(schema).validate(root)


def schema_faults(root: etree._Element, schema: str) -> list[tuple[etree._Element, str]]:
    """Return the elements that libxml2 objects to by the schema of this name, with its words; none if it is valid."""
    validator = _validator(schema)
    return [] if validator.validate(root) else list(_places(root, validator.error_log))


def schema_findings(
    root: etree._Element,
    schema: str,
    *,
    data: bytes,
    file: str | None = None,
    judge: Judge = lambda _element: Severity.ERROR,
) -> list[Diagnostic]:
    """Return the errors of a document by the schema of this name; empty for a valid one.

    `root` may be inside of a document that another schema describes. `data` are the bytes that the document was read
    from: the line numbers of long files are counted in them. At most
    `MAX_FINDINGS`, then one more (``XSD099``) with the number of places that were left out.
    """
    validator = _validator(schema)
    if validator.validate(root):
        return []
    # Only a file with errors pays for loading xmlschema.
    from plcopen_sfc.formats.xml.schema_explanation import explain_fault  # noqa: PLC0415

    path = schema_path(schema)
    lines = SourceLines(root.getroottree().getroot(), data)
    found: list[Diagnostic] = []
    left_out = 0
    for element, fallback in _places(root, validator.error_log):
        if len(found) >= MAX_FINDINGS:
            left_out += 1
            continue
        for code, message, place in explain_fault(element, path, fallback):
            location = Location(file, lines.line(place), path=element_path(place))
            finding = Diagnostic(code, judge(place), message, location)
            if finding not in found:
                found.append(finding)
    found.sort(key=lambda finding: finding.location.line or 0)
    if left_out:
        message = f"{left_out} more faulty places are not listed; repair these first"
        found.append(Diagnostic("XSD099", Severity.INFO, message, Location(file)))
    return found


def _places(root: etree._Element, log: etree._ListErrorLog) -> Iterator[tuple[etree._Element, str]]:
    """Yield the elements that libxml2 objects to, each once, with libxml2's own words for want of better ones."""
    objections = grouped((str(getattr(entry, "path", None) or "/*"), _plain(entry.message)) for entry in log)
    for path, messages in objections.items():
        yield _element_at(root, path), "; ".join(dict.fromkeys(messages))


_STEP = re.compile(r"([^/\[\]]+)(?:\[(\d+)\])?")


def _element_at(root: etree._Element, path: str) -> etree._Element:
    """Return the element at a path as libxml2 writes it: ``/*/*[3]/v:own[2]``.

    It is no XPath to evaluate: prefixes are those of the elements, and ``*`` means the default namespace.
    """
    element = root
    for name, number in _STEP.findall(path)[1:]:
        children = (child for child in element if isinstance(child.tag, str))
        fitting = (child for child in children if name in {"*", _prefixed(child)})
        found = next(islice(fitting, int(number or 1) - 1, None), None)
        if found is None:
            break
        element = found
    return element


def _prefixed(element: etree._Element) -> str:
    local = etree.QName(element).localname
    return f"{element.prefix}:{local}" if element.prefix else local


def _plain(message: str) -> str:
    return re.sub(r"\{[^{}]*\}", "", message).strip()


def element_path(element: etree._Element) -> str:
    """Return the place of an element, with names instead of numbers where there are any: an XPath for people.

    Namespaces are left out.
    """
    parts = []
    node: etree._Element | None = element
    while node is not None:
        parent = node.getparent()
        parts.append(_part(node, parent))
        node = parent
    return "/" + "/".join(reversed(parts))


def _part(node: etree._Element, parent: etree._Element | None) -> str:
    if not isinstance(node.tag, str):
        return "node()"
    local = etree.QName(node).localname
    key = next((key for key in _KEYS if node.get(key)), None)
    if key is not None and parent is not None:
        value = str(node.get(key))
        quote = "'" if '"' in value else '"'
        return f"{local}[@{key}={quote}{value}{quote}]"
    if parent is None or sum(1 for _ in parent.iterchildren(node.tag)) < 2:
        return local
    return f"{local}[{1 + sum(1 for _ in node.itersiblings(node.tag, preceding=True))}]"
