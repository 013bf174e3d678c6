"""The model as JSON: everything, exactly. `plcopen-sfc schema` prints its JSON Schema."""

from __future__ import annotations

import json
import re

from pydantic import ValidationError

from plcopen_sfc.errors import EncodingError, FormatError, Location, StructureError, UnknownVersionError
from plcopen_sfc.formats.format_interface import Codec, ReadResult, WriteOptions
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import ConversionReport, Outcome

_VERSION = 1


_SURROGATE = re.compile(rb"\\u[dD][89a-fA-F]")


class JsonCodec(Codec):
    """The model as JSON."""

    def read(self, data: bytes, *, file: str | None = None) -> ReadResult:
        """Read a saved model. Raises `FormatError`."""
        try:
            content = json.loads(data.decode("utf-8-sig"))
        except UnicodeDecodeError as error:
            raise EncodingError(f"not UTF-8: {error.reason}", location=Location(file)) from error
        except RecursionError as error:
            raise FormatError("this JSON is nested too deeply", location=Location(file)) from error
        except json.JSONDecodeError as error:
            place = Location(file, error.lineno, error.colno)
            raise FormatError(f"not JSON: {error.msg}", location=place) from error
        except ValueError as error:  # Python reads no number of more than 4300 digits
            raise FormatError(f"not JSON that can be read: {error}", location=Location(file)) from error
        if _SURROGATE.search(data):
            try:
                json.dumps(content, ensure_ascii=False).encode()
            except UnicodeEncodeError as error:
                half = ord(error.object[error.start])
                raise EncodingError(f"U+{half:04X} alone is no character", location=Location(file)) from error
        if not isinstance(content, dict) or content.get("format") != "plcopen_sfc" or "project" not in content:
            raise StructureError("this JSON is no model that plcopen_sfc has saved", location=Location(file))
        if content.get("version") != _VERSION:
            raise UnknownVersionError(
                f"version {content.get('version')!r} of the model is not known", location=Location(file)
            )
        try:
            project = Project.model_validate(content["project"])
        except ValidationError as error:
            first = error.errors()[0]
            path = ".".join(map(str, first["loc"]))
            raise StructureError(f"{path}: {first['msg']}", location=Location(file, path=path)) from error
        return ReadResult(project, [])

    def write(self, project: Project, options: WriteOptions, report: ConversionReport) -> bytes:
        """Write the model."""
        content = {
            "format": "plcopen_sfc",
            "version": _VERSION,
            "project": project.model_dump(mode="json", exclude_none=True),
        }
        report.add(Outcome.KEPT, "project", project.name)
        return (json.dumps(content, ensure_ascii=False, indent=1) + "\n").encode()


CODEC = JsonCodec()
