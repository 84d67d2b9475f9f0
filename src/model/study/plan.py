"""A computation as data: numbers only, so that a changed caption computes nothing anew."""

import hashlib

from pydantic import BaseModel, ConfigDict


class Plan(BaseModel):
    """Everything that results depend on besides the code."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    @property
    def identity(self) -> str:
        """Hash of the plan's JSON: equal for plans that give equal results."""
        return hashlib.sha256(self.model_dump_json().encode()).hexdigest()[:16]
