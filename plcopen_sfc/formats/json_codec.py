"""The model as JSON: everything, exactly. `plcopen-sfc schema` prints its JSON Schema."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable

from pydantic import ValidationError

from plcopen_sfc.errors import EncodingError, FormatError, Location, StructureError, UnknownVersionError
from plcopen_sfc.formats.format_interface import Codec, ReadResult, WriteOptions
from plcopen_sfc.model.checked import first_misfit
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import ConversionReport, Outcome

_VERSION = 1
_DEEPEST = 200
"""Objects in objects that the messages of errors follow: a model has some forty."""
_SURROGATE = re.compile(r"\\u[dD][89a-fA-F]")
_LONG_NUMBER = re.compile(r"\d{4301}")
_BLANKS = re.compile(r"[ \t\r\n]*")
_BRACKET = re.compile(r'"(?:[^"\\]|\\.)*"|([\[{])|([\]}])')


class JsonCodec(Codec):
    """The model as JSON."""

    def read(self, data: bytes, *, file: str | None = None) -> ReadResult:
        """Read a saved model. Raises `FormatError`."""
        try:
            text = data.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            place = Location(file, data.count(b"\n", 0, error.start) + 1)
            raise EncodingError(f"not UTF-8: {error.reason}", location=place) from error
        content = _content(text, file)
        if not isinstance(content, dict) or content.get("format") != "plcopen_sfc" or "project" not in content:
            raise StructureError("this JSON is no model that plcopen_sfc has saved", location=Location(file, 1))
        if content.get("version") != _VERSION:
            message = f"version {content.get('version')!r} of the model is not known"
            raise UnknownVersionError(message, location=Location(file, _line_of(text, ["version"])))
        try:
            project = Project.model_validate(content["project"])
        except ValidationError as error:
            first = error.errors()[0]
            path = ".".join(map(str, first["loc"]))
            place = Location(file, _line_of(text, ["project", *first["loc"]]), path=path)
            raise StructureError(first_misfit(error), location=place) from error
        return ReadResult(project, [])

    def write(self, project: Project, options: WriteOptions, report: ConversionReport) -> bytes:
        """Write the model."""
        fields = project.model_dump(mode="json", exclude_none=True)
        content = {"format": "plcopen_sfc", "version": _VERSION, "project": fields}
        report.add(Outcome.KEPT, "project", project.name)
        return (json.dumps(content, ensure_ascii=False, indent=1) + "\n").encode()


def _content(text: str, file: str | None) -> object:
    """Return the content of a text in JSON. Raises `FormatError`."""

    def place(position: int) -> Location:
        return Location(file, text.count("\n", 0, position) + 1)

    try:
        content: object = json.loads(text)
    except RecursionError as error:
        depth = 0
        for bracket in _BRACKET.finditer(text):
            depth += (bracket[1] is not None) - (bracket[2] is not None)
            if depth > _DEEPEST:
                break
        raise FormatError("this JSON is nested too deeply", location=place(bracket.start())) from error
    except json.JSONDecodeError as error:
        raise FormatError(f"not JSON: {error.msg}", location=Location(file, error.lineno, error.colno)) from error
    except ValueError as error:  # Python reads no number of more than 4300 digits
        number = _LONG_NUMBER.search(text)
        position = number.start() if number is not None else 0
        raise FormatError(f"not JSON that can be read: {error}", location=place(position)) from error
    if found := _SURROGATE.search(text):
        try:
            json.dumps(content, ensure_ascii=False).encode()
        except UnicodeEncodeError as error:
            half = ord(error.object[error.start])
            raise EncodingError(f"U+{half:04X} alone is no character", location=place(found.start())) from error
    return content


def _line_of(text: str, keys: Iterable[str | int]) -> int:
    """Return the line of a value by the keys and indices that lead to it, or of what is around it."""
    decoder = json.JSONDecoder()
    start = _behind_blanks(text, 0)
    for key in keys:  # some are kinds of objects, as pydantic calls them, and no keys
        start = _member(decoder, text, start, key)
    return text.count("\n", 0, start) + 1


def _member(decoder: json.JSONDecoder, text: str, start: int, key: str | int) -> int:
    """Return where the value of `key` in the value at `start` is; `start` where there is none."""
    if text[start] not in "{[":
        return start
    position, index = _behind_blanks(text, start + 1), 0
    while text[position] not in "}]":
        name: object = index
        if text[start] == "{":
            name, position = decoder.raw_decode(text, position)
            position = _behind_blanks(text, _behind_blanks(text, position) + 1)
        if name == key:
            return position
        position = _behind_blanks(text, decoder.raw_decode(text, position)[1])
        if text[position] == ",":
            position = _behind_blanks(text, position + 1)
        index += 1
    return start


def _behind_blanks(text: str, position: int) -> int:
    blanks = _BLANKS.match(text, position)
    return blanks.end() if blanks is not None else position


CODEC = JsonCodec()
