"""The base of every settings class: one definition for Python, the command line and TOML."""

from pydantic import BaseModel, ConfigDict

from panokit.provenance import digest_of


class Settings(BaseModel):
    """Frozen settings of one stage; unknown fields are errors.

    A subclass documents each field with a string below it: that text is the command line's help.
    Angles, lengths and sizes carry their unit in the name.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    @property
    def digest(self) -> str:
        """Equal settings have equal digests; part of a stage's key."""
        return digest_of(self.model_dump(mode="json"))
