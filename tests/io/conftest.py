"""EXR files byte by byte: what the OpenEXR package reads but cannot write, and lies."""

import struct

import numpy as np
import pytest

_TYPES = {np.dtype(np.uint32): 0, np.dtype(np.float16): 1, np.dtype(np.float32): 2}


def attribute(name, kind, data):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(data)) + data


class RawExr:
    """An uncompressed EXR file, from the file layout document of OpenEXR."""

    def __init__(self, planes, window=None, sampling=None, tile=None, mipmap=False, extra=b""):
        self.planes = dict(sorted(planes.items()))
        self.sampling = sampling or {}
        self.tile, self.mipmap, self.extra = tile, mipmap, extra
        full = next(p for n, p in self.planes.items() if self.sampling.get(n, 1) == 1)
        self.height, self.width = full.shape
        self.window = window or (0, 0, self.width - 1, self.height - 1)

    def header(self):
        channels = b"".join(
            name.encode() + b"\0" + struct.pack(
                "<iB3xii", _TYPES[plane.dtype], 0, *[self.sampling.get(name, 1)] * 2
            )
            for name, plane in self.planes.items()
        ) + b"\0"  # fmt: skip
        box = struct.pack("<4i", *self.window)
        data = (
            attribute("channels", "chlist", channels)
            + attribute("compression", "compression", b"\0")
            + attribute("dataWindow", "box2i", box)
            + attribute("displayWindow", "box2i", box)
            + attribute("lineOrder", "lineOrder", b"\0")
            + attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
            + attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0))
            + attribute("screenWindowWidth", "float", struct.pack("<f", 1))
            + self.extra
        )
        if self.tile:
            mode = bytes([1 if self.mipmap else 0])
            data += attribute("tiles", "tiledesc", struct.pack("<2I", *[self.tile] * 2) + mode)
        flags = 0x200 if self.tile else 0
        return b"\x76\x2f\x31\x01" + struct.pack("<i", 2 | flags) + data + b"\0"

    def chunks(self):
        if self.tile:
            yield from self.tiles()
            return
        for row in range(self.height):
            data = b""
            for name, plane in self.planes.items():
                step = self.sampling.get(name, 1)
                if row % step == 0:
                    data += plane[row // step].tobytes()
            yield struct.pack("<2i", self.window[1] + row, len(data)) + data

    def tiles(self):
        levels = int(np.log2(max(self.width, self.height))) + 1 if self.mipmap else 1
        for level in range(levels):
            width, height = max(1, self.width >> level), max(1, self.height >> level)
            for y in range(0, height, self.tile):
                for x in range(0, width, self.tile):
                    cell = np.s_[y : min(y + self.tile, height), x : min(x + self.tile, width)]
                    # Other levels hold what must never be read.
                    planes = [
                        plane[cell] if level == 0 else np.full(plane[cell].shape, 7, plane.dtype)
                        for plane in self.planes.values()
                    ]
                    data = b"".join(
                        plane[row].tobytes() for row in range(len(planes[0])) for plane in planes
                    )
                    place = (x // self.tile, y // self.tile, level, level, len(data))
                    yield struct.pack("<5i", *place) + data

    def to_bytes(self):
        header, chunks = self.header(), list(self.chunks())
        offset = len(header) + 8 * len(chunks)
        table = b""
        for chunk in chunks:
            table += struct.pack("<Q", offset)
            offset += len(chunk)
        return header + table + b"".join(chunks)


@pytest.fixture
def raw_exr():
    return RawExr
