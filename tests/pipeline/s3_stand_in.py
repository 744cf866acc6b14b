"""A few calls of S3, enough to publish and to read: a stand-in on this machine, in memory."""

import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from urllib.parse import parse_qs, unquote, urlsplit
from xml.sax.saxutils import escape


class S3StandIn:
    """Buckets in memory on 127.0.0.1; use it in a `with` block.

    Attributes:
        objects: "bucket/key" -> content.
        ranges: The ranges of bytes that were asked for.
    """

    def __init__(self) -> None:
        self.objects: dict[str, bytes] = {}
        self.ranges: list[str] = []

    def __enter__(self) -> "S3StandIn":
        stand_in = self

        class Handler(_Handler):
            owner = stand_in

        self._server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        threading.Thread(target=self._server.serve_forever, daemon=True).start()
        return self

    def __exit__(self, *_: object) -> None:
        self._server.shutdown()
        self._server.server_close()

    @property
    def url(self) -> str:
        """Its address."""
        return f"http://127.0.0.1:{self._server.server_port}"


class _Handler(BaseHTTPRequestHandler):
    owner: S3StandIn
    protocol_version = "HTTP/1.1"

    def log_message(self, *_: object) -> None:
        """Say nothing."""

    @property
    def _name(self) -> str:
        return unquote(urlsplit(self.path).path).strip("/")

    def do_HEAD(self) -> None:
        found = self.owner.objects.get(self._name)
        self._answer(200 if found is not None else 404, found or b"")

    def do_GET(self) -> None:
        query = parse_qs(urlsplit(self.path).query)
        if "/" not in self._name:
            self._answer(200, self._listing(query), "application/xml")
            return
        found = self.owner.objects.get(self._name)
        if found is None:
            self._answer(404, b"<Error><Code>NoSuchKey</Code></Error>", "application/xml")
            return
        asked = self.headers.get("Range", "")
        if asked:
            self.owner.ranges.append(asked)
            first, _, last = asked.removeprefix("bytes=").partition("-")
            part = found[int(first) : int(last) + 1 if last else None]
            self._answer(206, part, range_of=(int(first), len(part), len(found)))
        else:
            self._answer(200, found)

    def do_PUT(self) -> None:
        body = self.rfile.read(int(self.headers.get("Content-Length", 0)))
        if "/" in self._name:
            if "aws-chunked" in self.headers.get("Content-Encoding", ""):
                body = _unchunked(body)
            self.owner.objects[self._name] = body
        self._answer(200, b"")

    def _listing(self, query: dict[str, list[str]]) -> bytes:
        bucket = self._name
        prefix = query.get("prefix", [""])[0]
        delimiter = query.get("delimiter", [""])[0]
        keys, folders = [], set()
        for name in sorted(self.owner.objects):
            key = name.partition("/")[2]
            if name.partition("/")[0] != bucket or not key.startswith(prefix):
                continue
            rest = key[len(prefix) :]
            if delimiter and delimiter in rest:
                folders.add(prefix + rest.partition(delimiter)[0] + delimiter)
            else:
                keys.append((key, len(self.owner.objects[name])))
        contents = "".join(
            f"<Contents><Key>{escape(key)}</Key><Size>{size}</Size>"
            "<LastModified>2026-01-01T00:00:00.000Z</LastModified><ETag>x</ETag></Contents>"
            for key, size in keys
        )
        prefixes = "".join(
            f"<CommonPrefixes><Prefix>{escape(one)}</Prefix></CommonPrefixes>"
            for one in sorted(folders)
        )
        return (
            '<?xml version="1.0"?><ListBucketResult '
            'xmlns="http://s3.amazonaws.com/doc/2006-03-01/">'
            f"<Name>{bucket}</Name><IsTruncated>false</IsTruncated>"
            f"<KeyCount>{len(keys) + len(folders)}</KeyCount>{contents}{prefixes}"
            "</ListBucketResult>"
        ).encode()

    def _answer(
        self,
        status: int,
        body: bytes,
        kind: str = "binary/octet-stream",
        range_of: tuple[int, int, int] | None = None,
    ) -> None:
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(body)))
        self.send_header("ETag", '"x"')
        self.send_header("Last-Modified", "Thu, 01 Jan 2026 00:00:00 GMT")
        if range_of is not None:
            first, size, whole = range_of
            self.send_header("Content-Range", f"bytes {first}-{first + size - 1}/{whole}")
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(body)


def _unchunked(body: bytes) -> bytes:
    """What an upload in signed pieces holds: lines of sizes, each before its piece."""
    parts = []
    while body:
        line, _, body = body.partition(b"\r\n")
        size = int(line.partition(b";")[0] or b"0", 16)
        if size == 0:
            break
        parts.append(body[:size])
        body = body[size + 2 :]
    return b"".join(parts)
