"""The steps that made a file: append-only, and the same for the same bytes.

Nothing here depends on the clock or the machine, so that two runs with the same inputs,
settings and weights write the same provenance, byte for byte.
"""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from panokit.errors import RecordError


def canonical_json(value: Any) -> str:
    """JSON with sorted keys and no spaces, so that equal values have equal text."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"), ensure_ascii=False)


def digest_of(value: Any) -> str:
    """The SHA-256, in hex, of a JSON value's canonical text."""
    return hashlib.sha256(canonical_json(value).encode()).hexdigest()


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """One stage's part in making a file.

    Attributes:
        stage: The verb: "fetch", "stitch", "inpaint", "expand", ...
        version: The stage's own version; it changes when the same input gives other bytes.
        settings_digest: Of the stage's settings, see `digest_of`.
        input_digests: SHA-256 of each input file or record, in order.
        weights_digest: SHA-256 of the network's weights, "" where there are none.
        values: What the stage found out or decided, as JSON values: the energy before and
            after, the tiles that were missing, how the picture was leveled.
    """

    stage: str
    version: str
    settings_digest: str = ""
    input_digests: tuple[str, ...] = ()
    weights_digest: str = ""
    values: Mapping[str, Any] = field(default_factory=dict)

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`."""
        return {
            "stage": self.stage,
            "version": self.version,
            "settings_digest": self.settings_digest,
            "input_digests": list(self.input_digests),
            "weights_digest": self.weights_digest,
            "values": dict(self.values),
        }


@dataclass(frozen=True, slots=True)
class Provenance:
    """The chain of steps that made a file, oldest first."""

    steps: tuple[Step, ...] = ()

    def then(self, step: Step) -> "Provenance":
        """This chain with one more step at its end."""
        return Provenance((*self.steps, step))

    def with_inputs(self, input_digests: Sequence[str]) -> "Provenance":
        """This chain with the inputs of its last step filled in, by whoever read the files."""
        *earlier, last = self.steps
        return Provenance((*earlier, replace(last, input_digests=tuple(input_digests))))

    def last(self, stage: str) -> Step | None:
        """The latest step of a stage, or None."""
        return next((step for step in reversed(self.steps) if step.stage == stage), None)

    @property
    def digest(self) -> str:
        """Equal digests promise equal bytes."""
        return digest_of(self.to_json())

    def to_json(self) -> list[dict[str, Any]]:
        """A list for `json.dump`."""
        return [step.to_json() for step in self.steps]

    @classmethod
    def from_json(cls, records: Any) -> "Provenance":
        """The chain that `to_json` wrote.

        Raises:
            RecordError: If it is not one.
        """
        try:
            return cls(
                tuple(
                    Step(**{**record, "input_digests": tuple(record["input_digests"])})
                    for record in records
                )
            )
        except (KeyError, TypeError) as error:
            raise RecordError(
                f"This is not a provenance record ({error}). Make the file again.",
                reason="bad-provenance-record",
            ) from error
