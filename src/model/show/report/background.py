"""Sections of background: how to read the figures, the device, the equations, the provenance."""

from collections.abc import Mapping
from pathlib import Path

from markupsafe import Markup

from model.events.outcomes import OUTCOME_TEXT, Outcome
from model.physics.parameters import FIELDS
from model.physics.readings import READING_NAMES
from model.show.report.section import Results, Section, Table, symbol
from model.show.words import number
from model.tracking.provenance import file_hash, versions

# Number and subject of every disputed equation; model.physics.readings says what each value does.
READING_WORDS: Mapping[str, tuple[str, str]] = {
    "normal_sign": ("R1", "sign of the horizontal component of the contact force"),
    "friction_law": ("R2", "Coulomb friction with sticking, or one fixed direction"),
    "contact_damping_law": ("R3", "damping by the closing rate, or by the speed of the part"),
    "side_gap": ("R4", "distance of the edge A2 from the side face"),
    "side_force": ("R5", "direction of the force on the side face"),
    "preload": ("R6", "pose in which the axial spring is relaxed: at the start, or at y = 0"),
    "alignment_criterion": ("R8", "loss of the contact over the slot, or the four corners inside"),
    "moment_arms": ("R9", "arms of the deformed or of the undeformed contact"),
}
_CODE = Markup("<code>{}</code>")


def _template(name: str) -> Path:
    return Path(__file__).with_name(f"background.{name}.html.j2")


def reading(_: Results) -> Section:
    """Return the section on how to read the figures, with the meaning of every outcome."""
    rows = [(_CODE.format(each.name.lower()), OUTCOME_TEXT[each]) for each in Outcome]
    outcomes = Table(("outcome", "meaning"), rows)
    return Section(
        "reading", "How to read the figures", _template("reading"), {"outcomes": outcomes}
    )


def device(results: Results) -> Section:
    """Return the section on the device of the study."""
    rows = [
        (symbol(FIELDS[name].symbol), _CODE.format(name), number(value), FIELDS[name].description)
        for name, value in results.study.structure.items()
    ]
    structure = Table(("symbol", "name", ">value", "meaning"), rows)
    return Section("device", "The device", _template("device"), {"structure": structure})


def equations(results: Results) -> Section:
    """Return the section on the variants of the equations that the figures use."""
    settings = results.study.settings.settings
    rows = []
    for name in READING_NAMES:
        index, words = READING_WORDS[name]
        rows.append((index, _CODE.format(name), words, getattr(settings.readings, name)))
    variants = Table(("no.", "variant", "what it decides", "in use"), rows)
    content = {"variants": variants, "settings": settings}
    return Section("equations", "How the equations are read", _template("equations"), content)


def provenance(results: Results) -> Section:
    """Return the section on what the page was made from.

    It has nothing of the day, the machine or the checkout, so that the same data give the same
    bytes.
    """
    facts = {
        "made with": versions(),
        "from": {place: file_hash(path)[:16] for place, path in results.data.items()},
        "when, where, at which commit": {
            "": "runs.csv and history/ beside this page; vibralign runs"
        },
    }
    return Section("provenance", "Provenance", _template("provenance"), {"facts": facts})
