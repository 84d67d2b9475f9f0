"""Section of background: the device with all parameters, the equations, the provenance."""

from collections.abc import Mapping
from pathlib import Path

from markupsafe import Markup

from model.engine.series_layout import METHOD
from model.physics.parameters import FIELDS, OF_PAPER
from model.physics.variants import VARIANT_NAMES
from model.runs.settings import Settings
from study.report.section import Results, Section, Table, link, symbol, value_of, values_of
from study.tracking.checkout import versions
from vibralign.plots.words import figure_title, number

# Number and subject of every disputed equation; model.physics.variants explains its variants.
VARIANT_WORDS: Mapping[str, tuple[str, str]] = {
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


def section(results: Results) -> Section:
    """Return the section on the device, the equations in use, and what the page was made with."""
    device, points = _device(results)
    settings = results.study.settings.settings
    variants = (
        "Some of the paper's printed equations contradict each other or mechanics. Each such place "
        "has two variants: printed takes the equation as printed, consistent corrects it. Runs end "
        f"at τ = {number(settings.horizon)} at the latest; the local error of a step is kept below "
        f"{number(settings.tolerance)} by the method {METHOD}."
    )
    made = (
        "When, where, at which commit and from which data each file was made: "
        "python -m study show, from the records beside this page."
    )
    packages = [(name, _CODE.format(version)) for name, version in versions().items()]
    # Anchor, heading, words and table.
    parts = [
        ("parameters", "The device of all figures", "", device),
        ("points", "Parameters of each figure; varied ones in bold type", "", points),
        ("equations", "How the equations are read", variants, _equations(settings)),
        ("provenance", "Made with", made, Table(("package", "version"), packages)),
    ]
    lead = (
        "The paper states only δ, x(0), φ(0), K_a and H_a; the rest was identified from what it "
        "says its figures show. All quantities are dimensionless: lengths in units of the "
        "excitation amplitude, time in units of the inverse natural frequency along the axis, "
        "forces in units of the excitation force."
    )
    title, template = "Device, equations, provenance", Path(__file__).with_suffix(".html.j2")
    return Section("device", title, template, {"parts": parts}, lead)


def _device(results: Results) -> tuple[Table, Table]:
    """Return two tables of parameters: the device, and what each figure varies or holds."""
    study = results.study
    datasets = {name: results.dataset(f"data/{name}.nc") for name in study.computed}
    varied = {name: {*map(str, each["outcome"].dims)} for name, each in datasets.items()}
    held = (study.figures[name].held for name in study.computed)
    own = {*study.operating_point}.union(*varied.values(), *held)
    columns = [name for name in OF_PAPER if name in own]
    device = [
        (symbol(FIELDS[name].symbol), _CODE.format(name),
         "by figure" if name in study.operating_point
         else value_of(name, getattr(study.baseline, name)), FIELDS[name].description)
        for name in OF_PAPER
    ]  # fmt: skip
    bold = Markup("<strong>{}</strong>")
    points = [
        (link(figure_title(figure), f"#{figure}"),
         *((bold if name in varied[figure] else Markup("{}")).format(values_of(dataset, name))
           for name in columns))
        for figure, dataset in datasets.items()
    ]  # fmt: skip
    symbols = (symbol(FIELDS[name].symbol) for name in columns)
    return (
        Table(("symbol", "name", ">value", "meaning"), device),
        Table(("figure", *symbols), points),
    )


def _equations(settings: Settings) -> Table:
    """Return the variants of the equations that the figures use."""
    rows = [
        (index, _CODE.format(name), words, getattr(settings.readings, name))
        for name, (index, words) in ((each, VARIANT_WORDS[each]) for each in VARIANT_NAMES)
    ]
    return Table(("no.", "variant", "what it decides", "in use"), rows)
