"""Files: pictures with their records, captures, atomic writes and digests.

pictures  panoramas and environment maps with the record beside them
captures  what fetch stores
images    8-bit pictures, every doubt named
exr, radiance, gpano  the formats
adapters  maps as other tools want them (`panokit.io.adapters`)
files     atomic writes, digests, JSON
"""

from panokit.io.captures import StoredCapture, read_capture, write_capture
from panokit.io.exr import iterate_exr_rows, read_exr, write_exr
from panokit.io.exr_header import ExrPart, read_exr_parts
from panokit.io.files import atomic_write, read_json, sha256_of_file, write_bytes, write_json
from panokit.io.images import decode_image, encode_jpeg, encode_png
from panokit.io.pictures import (
    HDR_SUFFIXES,
    read_environment_map,
    read_panorama,
    write_environment_map,
    write_panorama,
)
from panokit.io.radiance import (
    iterate_radiance_rows,
    read_radiance,
    read_radiance_header,
    read_radiance_rows,
    write_radiance,
    write_radiance_rows,
)
from panokit.io.radiance_header import RadianceHeader

__all__ = [
    "HDR_SUFFIXES",
    "ExrPart",
    "RadianceHeader",
    "StoredCapture",
    "atomic_write",
    "decode_image",
    "encode_jpeg",
    "encode_png",
    "iterate_exr_rows",
    "iterate_radiance_rows",
    "read_capture",
    "read_environment_map",
    "read_exr",
    "read_exr_parts",
    "read_json",
    "read_panorama",
    "read_radiance",
    "read_radiance_header",
    "read_radiance_rows",
    "sha256_of_file",
    "write_bytes",
    "write_capture",
    "write_environment_map",
    "write_exr",
    "write_json",
    "write_panorama",
    "write_radiance",
    "write_radiance_rows",
]
