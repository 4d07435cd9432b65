"""A file inside a PDF file: appended as an incremental update (ISO 32000-1, 7.5.6 and 7.11.4)."""

from __future__ import annotations

import re
import zlib


def attached(pdf: bytes, name: str, content: bytes) -> bytes:
    """Return a PDF file with one more file in it.

    Raises `ValueError`: the PDF file does not have the form that `pdf` states.

    Parameters
    ----------
    pdf : bytes
        File with a table of references at its end, not a stream of them, and a catalog without names.
    name : str
        Name of the file, in ASCII without brackets.
    """
    last, size, root = _end(pdf)
    catalogs = re.findall(rb"\n%d 0 obj\n<<(.*?)>>\nendobj" % root, pdf, re.S)
    if not catalogs or b"/Names" in catalogs[-1]:
        raise ValueError("the PDF file has names already, or no catalog")
    packed, label = zlib.compress(content, 9), f"({name})".encode("ascii")
    stream, file = size, size + 1
    objects = {
        root: b"<<%b\n/Names <</EmbeddedFiles <</Names [%b %d 0 R]>>>>\n/AF [%d 0 R]>>"
        % (catalogs[-1], label, file, file),
        stream: b"<</Type /EmbeddedFile\n/Subtype /application#2Fjson\n/Filter /FlateDecode\n"
        b"/Params <</Size %d>>\n/Length %d>> stream\n%b\nendstream" % (len(content), len(packed), packed),
        file: b"<</Type /Filespec\n/F %b\n/UF %b\n/AFRelationship /Data\n/EF <</F %d 0 R>>>>"
        % (label, label, stream),
    }
    extended, table = pdf, b"xref\n"
    for number, body in objects.items():
        table += b"%d 1\n%010d 00000 n \n" % (number, len(extended))
        extended += b"%d 0 obj\n%b\nendobj\n" % (number, body)
    trailer = b"trailer\n<</Size %d\n/Root %d 0 R\n/Prev %d>>\n" % (size + 2, root, last)
    return extended + table + trailer + b"startxref\n%d\n%%%%EOF\n" % len(extended)


def _end(pdf: bytes) -> tuple[int, int, int]:
    """Return the offset of the last table of references, the count of objects, the catalog's number."""
    trailer = pdf[pdf.rfind(b"trailer") :]
    matches = [re.search(rb"%b\s+(\d+)" % name, trailer) for name in (b"startxref", b"/Size", b"/Root")]
    if not all(matches):
        raise ValueError("the PDF file has no trailer")
    last, size, root = (int(match[1]) for match in matches if match)
    return last, size, root
