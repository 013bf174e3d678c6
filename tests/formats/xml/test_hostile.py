"""Files made to hurt: refused in a bounded process, with a clear error, little memory and little time."""

from __future__ import annotations

import os
import subprocess
import sys
import textwrap
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.skipif(os.name == "nt", reason="resource limits are POSIX only")


def _read_bounded(make: str, *, extra_mb: int, seconds: int = 20) -> str:
    """The error for `data`, which `make` creates, with `extra_mb` of memory besides the data and `seconds` of time."""
    code = f"""
    import resource, sys
    from plcopen_sfc.errors import SfcError
    from plcopen_sfc.formats.xml.xml_parsing import parse_xml
    {make}
    used = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
    limit = used + {extra_mb} * 2**20
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    resource.setrlimit(resource.RLIMIT_CPU, ({seconds}, {seconds}))
    try:
        parse_xml(data, file="hostile.xml")
        print("read")
    except SfcError as error:
        print(type(error).__name__, error)
    """
    result = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(code)], capture_output=True, text=True, check=False, timeout=120
    )
    assert result.returncode == 0, result.stderr[-2000:]
    return result.stdout


_LAUGHS = """data = b"<!DOCTYPE l [<!ENTITY a0 'ha'>" + b"".join(
        b"<!ENTITY a%d '%s'>" % (n, b"&a%d;" % (n - 1) * 10) for n in range(1, 12)) + b"]><l x='&a11;'>&a11;</l>" """


@pytest.mark.slow
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
@pytest.mark.parametrize(
    ("make", "words"),
    [
        (_LAUGHS, "UnsafeXmlError hostile.xml:1: the document type declaration"),
        (_LAUGHS + ".decode().encode('utf-16')", "UnsafeXmlError"),
        ("data = b'<a>' * 1_000_000", "UnsafeXmlError hostile.xml:1: elements are nested deeper"),
        ("data = b'<a>\\n' * 1_000_000 + b'</a>' * 1_000_000", "UnsafeXmlError hostile.xml:25"),
        ("data = b'<!-- ' * 1_000_000", "XmlSyntaxError"),
        ("data = b'<a b=\"' * 1_000_000", "XmlSyntaxError"),
        ("data = b'<!DOCTYPE a [' + b'<!--' * 300_000", "XmlSyntaxError"),
        ("data = b'<!DOCTYPE a [' + b'\"' * 1_000_001", "XmlSyntaxError"),
        ("data = b'<?x ' * 300_000", "XmlSyntaxError"),
        ("data = b' ' * 5_000_000 + b'<a'", "XmlSyntaxError"),
        ("data = b'<a>' + b'&#0;' * 100_000 + b'</a>'", "XmlSyntaxError"),
        ("data = b'<a ' + b' '.join(b'a%d=\"\"' % n for n in range(200_000)) + b'>'", "XmlSyntaxError"),
        ("data = b'<' + b'a' * 5_000_000 + b'/>'", "XmlSyntaxError"),
    ],
)
def test_small_but_hostile(make: str, words: str) -> None:
    assert words in _read_bounded(make, extra_mb=150)


@pytest.mark.slow
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
@pytest.mark.parametrize(
    ("make", "words"),
    [
        ("data = b'<a>' * 70_000_000", "UnsafeXmlError hostile.xml:1: elements are nested deeper"),
        ("data = b'<a>' + b'x' * 11_000_000 + b'<a>' * 60_000_000", "UnsafeXmlError"),
        ("data = b'\\0' * 200_000_000", "XmlSyntaxError"),
        ("data = b'hello ' * 30_000_000", "plain text"),
    ],
)
def test_large_and_hostile(make: str, words: str) -> None:
    """200 MB of nesting, refused with less memory than the file itself takes."""
    assert words in _read_bounded(make, extra_mb=100)


def test_nothing_outside_is_touched(tmp_path: Path) -> None:
    """An external entity is not opened: opening a pipe without a writer would hang."""
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    for doctype in (f'<!DOCTYPE a SYSTEM "{pipe}">', f'<!DOCTYPE a [<!ENTITY x SYSTEM "{pipe}">]>'):
        make = f"data = {f'{doctype}<a>&x;</a>'.encode()!r}"
        assert "UnsafeXmlError" in _read_bounded(make, extra_mb=150)
    include = f"<a xmlns:xi='http://www.w3.org/2001/XInclude'><xi:include href='{pipe}'/></a>"
    assert _read_bounded(f"data = {include.encode()!r}", extra_mb=150) == "read\n"
