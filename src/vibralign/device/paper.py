"""The device of the paper's study, dimensionless: it runs where no other is stated."""

from pathlib import Path

from model.physics.parameters import Parameters
from model.sweeps.files import parse_yaml, read_text


def paper_file() -> Path:
    """Return the study's config.yaml, in the checkout or as it is shipped with the package."""
    in_checkout = Path(__file__).resolve().parents[3] / "config" / "config.yaml"
    return in_checkout if in_checkout.is_file() else Path(__file__).with_name("paper.yaml")


def baseline() -> Parameters:
    """Return the device of the paper's study at its default operating point, dimensionless."""
    stated = parse_yaml(read_text(paper_file()))
    return Parameters(**stated["structure"], **stated["operating_point"])
