"""What the library knows of one light map."""

import hashlib
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from panokit.capture import Capture, License
from panokit.envmap import Anchor, EnvironmentMap
from panokit.errors import RecordError
from panokit.frames import Frame
from panokit.probes.traits import category_of, kind_of, tags_of
from panokit.provenance import Provenance, canonical_json
from panokit.qa import Report

ID_LENGTH = 16


@dataclass(frozen=True, slots=True, kw_only=True)
class Source:
    """The file of a map that is used in place.

    Attributes:
        path: Where it is: absolute, or from the library's folder.
        bytes: How large it was when it was added.
        sha256: Of its content then.
    """

    path: str
    bytes: int
    sha256: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Probe:
    """A light map in the library, without its pixels.

    Attributes:
        id: Names it for good; see `probe_id`.
        name: What it was called when it was added.
        width_px: Of the map; twice its height.
        frame: Which way its center column and rows look.
        anchor: What a radiance of 1.0 stands for.
        capture: Where it is from, or None.
        provenance: The steps that made it.
        report: What QA said when it was added.
        files: Name in the probe's folder -> bytes and sha256.
        kind: "native" was captured in HDR, "lifted" made of a photograph, "synthetic" rendered.
        category: The kind of scene ("outdoor_night"), "" where it is not known.
        tags: Words to find it by, in order.
        sun: Direction, irradiance and radius of the sun as its record has them, or None.
        descriptor: What light it has, see `panokit.probes.descriptors`; () if not known.
        source: Where the map lies, for one that is used in place; None for one in the library.
    """

    id: str
    name: str
    width_px: int
    frame: Frame
    anchor: Anchor
    capture: Capture | None
    provenance: Provenance
    report: Report
    files: Mapping[str, Mapping[str, Any]]
    kind: str = "native"
    category: str = ""
    tags: tuple[str, ...] = ()
    sun: Mapping[str, Any] | None = None
    descriptor: tuple[float, ...] = ()
    source: Source | None = None

    @property
    def license(self) -> License:
        """The license of the capture; "unknown" where there is none."""
        return self.capture.license if self.capture else License(id="unknown", attribution="")

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`: all that is known, for programs."""
        return {
            "id": self.id,
            "name": self.name,
            "kind": self.kind,
            "category": self.category,
            "tags": list(self.tags),
            "width_px": self.width_px,
            "frame": str(self.frame),
            "anchor": str(self.anchor),
            "license": asdict(self.license),
            "capture": self.capture and self.capture.to_json(),
            "provenance": self.provenance.to_json(),
            "report": self.report.to_json(),
            "sun": self.sun and dict(self.sun),
            "descriptor": list(self.descriptor),
            "source": self.source and asdict(self.source),
            "files": {name: dict(entry) for name, entry in self.files.items()},
        }

    @classmethod
    def from_record(cls, record: Mapping[str, Any]) -> "Probe":
        """The probe that a probe.json describes.

        Raises:
            RecordError: If it does not.
        """
        try:
            own = record["probe"]
            capture = Capture.from_json(record["capture"]) if record["capture"] else None
            provenance = Provenance.from_json(record["provenance"])
            source = record.get("source")
            return cls(
                id=own["id"],
                name=own["name"],
                width_px=own["width_px"],
                frame=Frame(record["frame"]),
                anchor=Anchor(record["anchor"]),
                capture=capture,
                provenance=provenance,
                report=Report.from_json(own["report"]),
                files=record["files"],
                kind=own.get("kind") or kind_of(capture, provenance),
                category=own.get("category", category_of(capture)),
                tags=tuple(own.get("tags", tags_of(capture))),
                sun=own.get("sun"),
                descriptor=tuple(own.get("descriptor", ())),
                source=Source(**source) if source else None,
            )
        except (KeyError, TypeError, ValueError) as error:
            raise RecordError(
                f"This is not the record of a probe ({error!r}). Add the map again.",
                reason="bad-probe-record",
            ) from error


def probe_id(envmap: EnvironmentMap) -> str:
    """The id of a map: the same for the same light from the same picture, whoever computes it.

    The first 16 hex digits of the SHA-256 of a line of canonical JSON (width, frame, anchor,
    and provider and id of the capture, or null) followed by the radiance as little-endian
    float32, row by row, RGB. Names, settings and clock times do not count.
    """
    capture = envmap.capture
    identity = {
        "width_px": envmap.width_px,
        "frame": str(envmap.frame),
        "anchor": str(envmap.anchor),
        "capture": [capture.provider, capture.id] if capture else None,
    }
    digest = hashlib.sha256(canonical_json(identity).encode() + b"\n")
    digest.update(np.ascontiguousarray(envmap.radiance, "<f4").data)
    return digest.hexdigest()[:ID_LENGTH]
