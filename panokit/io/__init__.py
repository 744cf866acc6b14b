"""Files: pictures with their records, captures, atomic writes and digests.

pictures  panoramas and environment maps with the record beside them
captures  what fetch stores
images    8-bit pictures, every doubt named
exr, radiance, gpano  the formats
files     atomic writes, digests, JSON
"""

from panokit.io.captures import StoredCapture, read_capture, write_capture
from panokit.io.files import atomic_write, read_json, sha256_of_file, write_bytes, write_json
from panokit.io.images import decode_image, encode_jpeg, encode_png
from panokit.io.pictures import (
    HDR_SUFFIXES,
    read_environment_map,
    read_panorama,
    write_environment_map,
    write_panorama,
)

__all__ = [
    "HDR_SUFFIXES",
    "StoredCapture",
    "atomic_write",
    "decode_image",
    "encode_jpeg",
    "encode_png",
    "read_capture",
    "read_environment_map",
    "read_json",
    "read_panorama",
    "sha256_of_file",
    "write_bytes",
    "write_capture",
    "write_environment_map",
    "write_json",
    "write_panorama",
]
