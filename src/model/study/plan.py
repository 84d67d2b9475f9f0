"""A computation as data: numbers only, no wording, so that a new caption computes nothing anew."""

import hashlib

from pydantic import BaseModel, ConfigDict


class Plan(BaseModel):
    """All that results depend on besides the code; its JSON is its identity."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    @property
    def identity(self) -> str:
        """Hash of that JSON."""
        return hashlib.sha256(self.model_dump_json().encode()).hexdigest()[:16]
