"""The base of a device: contact stiffness from materials and size, damping from restitution.

Contact stiffness: the edge of the hole, rounded with radius R, against the flat face of the part,
is the slope of Hertz's law F = 4/3 E* √R d^(3/2) at the press force: k = (6 E*² R F)^(1/3),
with 1/E* = (1 - ν1²)/E1 + (1 - ν2²)/E2 (K. L. Johnson, Contact Mechanics, 1985, sect. 4.2). A thin
round plate clamped at its rim and loaded at its centre is a spring in series:
k = 16 π D / c², D = E t³ / (12 (1 - ν²)) (S. Timoshenko, S. Woinowsky-Krieger, Theory of Plates and
Shells, 1959, art. 18).

Contact damping: the model's base is a spring with a damper that never pulls. An impact on it
returns the share e of the closing rate, which does not depend on the stiffness:

    e = exp(-ζ/√(1 - ζ²) β),  β = atan2(2ζ √(1 - ζ²), 2ζ² - 1)   for ζ < 1

(T. Schwager, T. Pöschel, Granular Matter 9, 2007, 465). The damping is h = 2ζ √(k m) with the
effective mass m = M/(1 + M s²/I) of the part at the edge on which it starts.
"""

import math
import re
from collections.abc import Mapping
from functools import lru_cache
from typing import Any, NamedTuple

from model.physics.geometry import lever_if_flat
from model.physics.parameters import Parameters, Shape
from model.physics.quantities import LENGTH, PLAIN, STIFFNESS, Quantity
from model.physics.tables import vars_of
from vibralign.device.mouth import middle_of_face
from vibralign.device.spelling import in_per_cent


class Material(NamedTuple):
    """Young's modulus in Pa and Poisson's ratio, at room temperature."""

    modulus: float
    poisson: float


# Round handbook values, such as M. F. Ashby, Materials Selection in Mechanical Design, App. A.
# Polyamides take up water: 2 GPa is halfway, PA-GF30 between 9.5 GPa dry and 6 GPa.
MATERIALS: Mapping[str, Material] = {
    "steel": Material(210e9, 0.30),
    "cast iron": Material(110e9, 0.26),
    "titanium": Material(114e9, 0.34),
    "brass": Material(100e9, 0.35),
    "aluminium": Material(70e9, 0.33),
    "copper": Material(120e9, 0.34),
    "bronze": Material(110e9, 0.34),
    "zinc": Material(85e9, 0.25),
    "magnesium": Material(45e9, 0.29),
    "alumina": Material(370e9, 0.22),
    "glass": Material(70e9, 0.22),
    "POM": Material(2.8e9, 0.35),
    "PEEK": Material(3.6e9, 0.38),
    "PA66": Material(2.0e9, 0.40),
    "ABS": Material(2.2e9, 0.37),
    "PP": Material(1.4e9, 0.42),
    "PE": Material(1.0e9, 0.44),  # of high density
    "PBT": Material(2.5e9, 0.39),
    "PET": Material(2.9e9, 0.40),
    "PC": Material(2.3e9, 0.38),
    "PMMA": Material(3.1e9, 0.38),
    "PPS": Material(3.8e9, 0.38),
    "PVC": Material(3.0e9, 0.38),
    "PTFE": Material(0.5e9, 0.46),
    "PA-GF30": Material(7.5e9, 0.37),
    "PBT-GF30": Material(9.5e9, 0.37),
}
_NAMES = {  # of data sheets, without spaces and hyphens
    **dict.fromkeys(("pa", "pa6", "pa12", "nylon"), "PA66"),
    **dict.fromkeys(("pomc", "pomh", "acetal", "delrin"), "POM"),
    **dict.fromkeys(("hdpe", "pehd"), "PE"),
    **dict.fromkeys(("pa6gf30", "pa66gf30"), "PA-GF30"),
    **dict.fromkeys(("aluminum", "alu"), "aluminium"),
    **dict.fromkeys(("stainlesssteel", "inox"), "steel"),
    "zamak": "zinc",
}

# Quantities of a base that a device file may state in place of parameters.
BASE: Mapping[str, tuple[str, Quantity]] = {
    "edge_radius": ("rounding of the hole's edge, for the contact stiffness of materials", LENGTH),
    "plate_thickness": ("thickness of a base that is a round plate, clamped at its rim", LENGTH),
    "plate_radius": ("radius of such a plate, to its rim", LENGTH),
    "restitution": ("coefficient of restitution, for the contact damping", PLAIN),
    "fixture_stiffness": ("stiffness of what holds the base, in series with it", STIFFNESS),
}

# Contact stiffness over axial stiffness where it is not stated. From 1,600 on the lever of a round
# part does not hang on the yielding of the rims (docs/decisions/0042-round-parts.md).
USUAL_STIFFNESS: Mapping[Shape, float] = {"square": 100.0, "round": 1600.0}

# Parameters, and the quantities of a device file from which they are computed if stated.
SOURCES: Mapping[str, tuple[str, ...]] = {
    "contact_stiffness": ("materials", "edge_radius", "plate_thickness", "plate_radius"),
    "contact_damping": ("restitution",),
}


@lru_cache(maxsize=64)
def pair_of(text: str) -> tuple[Material, Material]:
    """Return the materials of part and base, stated such as "steel on aluminium".

    Raises:
        ValueError: another form, or an unknown material.
    """
    known = {_plain(name): material for name, material in MATERIALS.items()}
    known |= {name: MATERIALS[own] for name, own in _NAMES.items()}
    names = [_plain(name) for name in str(text).casefold().split(" on ")]
    pair = [known[name] for name in names if name in known]
    if len(names) != 2 or len(pair) != 2:
        raise ValueError(
            f"materials = {text!r}: must be the part's on the base's, such as steel on aluminium, "
            f"of {', '.join(MATERIALS)}; for others state contact_stiffness"
        )
    return pair[0], pair[1]


def _plain(name: str) -> str:
    return re.sub(r"[\s.-]+", "", name.casefold())


def hertz_stiffness(pair: tuple[Material, Material], radius: float, force: float) -> float:
    """Return the contact stiffness in N/m of an edge (radius, m) on a face under a force (N)."""
    compliance = sum((1.0 - each.poisson**2) / each.modulus for each in pair)
    return math.cbrt(6.0 * radius * force / compliance**2)


def plate_stiffness(material: Material, thickness: float, radius: float) -> float:
    """Return the stiffness in N/m of a clamped round plate (sizes in m), loaded at its centre."""
    rigidity = material.modulus * thickness**3 / (12.0 * (1.0 - material.poisson**2))
    return 16.0 * math.pi * rigidity / radius**2


def in_series(one: Any, other: Any) -> Any:
    """Return the stiffness of two springs in series, of numbers or of arrays."""
    return 1.0 / (1.0 / one + 1.0 / other)


def restitution_of(ratio: float) -> float:
    """Return the coefficient of restitution of an impact with a damping ratio >= 0."""
    if ratio < 1.0:
        root = math.sqrt(1.0 - ratio * ratio)
        angle = math.atan2(2.0 * ratio * root, 2.0 * ratio * ratio - 1.0)
        return math.exp(-ratio / root * angle)
    if ratio == 1.0:
        return math.exp(-2.0)
    root = math.sqrt(ratio * ratio - 1.0)
    return math.exp(-ratio / root * 2.0 * math.atanh(root / ratio))


@lru_cache(maxsize=64)  # most devices within the tolerances have the same restitution
def damping_ratio_of(restitution: float) -> float:
    """Return the damping ratio that gives a coefficient of restitution, > 0 and <= 1."""
    low, high = 0.0, 1.0
    while restitution_of(high) > restitution:
        high *= 2.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if restitution_of(middle) > restitution else (low, middle)
    return 0.5 * (low + high)


def mass_at_edge(parameters: Mapping[str, Any], shape: Shape) -> Any:
    """Return the effective mass of the part at the edge, or tips, on which it starts flat.

    Of parameters in SI units with the ``mass``, in kg; or of dimensionless ones, in masses.
    """
    half_width, mass = parameters["half_width"], parameters.get("mass", 1.0)
    hole = half_width * (1.0 + parameters["clearance"])
    arm = lever_if_flat(half_width, hole, middle_of_face(parameters), shape)
    return mass / (1.0 + mass * arm * arm / parameters["inertia"])


def restitution_at(parameters: Parameters, shape: Shape) -> float:
    """Return the coefficient of restitution that a contact damping gives at the edge."""
    mass = mass_at_edge(vars_of(parameters), shape)
    stiffness, damping = parameters.contact_stiffness, parameters.contact_damping
    return restitution_of(damping / (2.0 * math.sqrt(stiffness * mass)))


def with_base(
    quantities: Mapping[str, float], pair: tuple[Material, Material] | None, shape: Shape
) -> dict[str, float]:
    """Return quantities in SI units, with contact stiffness and damping in place of the base's.

    A round part whose base is not stated gets that of ``USUAL_STIFFNESS``, with the damping ratio
    that the default of ``Parameters`` gives to a square one.

    Raises:
        ValueError: a quantity of the base outside its rule, one that another needs and that is
            missing, or two that state the same.
    """
    given = {name: value for name, value in quantities.items() if name in BASE}
    result = {name: value for name, value in quantities.items() if name not in BASE}
    _check_base(given, result, pair)
    if pair is not None:
        stiffness = hertz_stiffness(pair, given["edge_radius"], result["press_force"])
        if "plate_thickness" in given:
            plate = plate_stiffness(pair[1], given["plate_thickness"], given["plate_radius"])
            stiffness = in_series(stiffness, plate)
        result["contact_stiffness"] = stiffness
    if "contact_stiffness" not in result and shape == "round":
        stiffer = USUAL_STIFFNESS["round"]
        unit = math.sqrt(result["axial_stiffness"] * result["mass"])
        damping = math.sqrt(stiffer / USUAL_STIFFNESS["square"]) * unit
        result["contact_stiffness"] = stiffer * result["axial_stiffness"]
        result.setdefault("contact_damping", damping)
    if "fixture_stiffness" in given:
        usual = USUAL_STIFFNESS["square"] * result["axial_stiffness"]
        stiffness = result.get("contact_stiffness", usual)
        result["contact_stiffness"] = in_series(stiffness, given["fixture_stiffness"])
    if "restitution" in given:
        usual = USUAL_STIFFNESS["square"] * result["axial_stiffness"]
        stiffness = result.get("contact_stiffness", usual)
        ratio, mass = damping_ratio_of(given["restitution"]), mass_at_edge(result, shape)
        result["contact_damping"] = 2.0 * ratio * math.sqrt(stiffness * mass)
    return result


def _check_base(
    given: Mapping[str, float],
    parameters: Mapping[str, float],
    pair: tuple[Material, Material] | None,
) -> None:
    for name, value in given.items():
        limit = 1.0 if name == "restitution" else math.inf
        if not 0.0 < value <= limit or math.isinf(value):
            most = " and <= 1" if name == "restitution" else ""
            most += in_per_cent(value) if limit < value <= 100.0 else ""
            raise ValueError(f"{name} = {value!r}: must be a finite number > 0{most}")
    sizes = set(given) - {"restitution", "fixture_stiffness"}
    if pair is None and sizes:
        raise ValueError(f"{min(sizes)} needs materials, such as steel on aluminium")
    if pair is not None and "edge_radius" not in given:
        raise ValueError(
            "materials needs edge_radius, the rounding of the hole's edge, such as edge_radius: "
            "0.1 mm; or leave materials out, and assess tries bases up to steel"
        )
    if len(sizes & {"plate_thickness", "plate_radius"}) == 1:
        raise ValueError("a plate needs both plate_thickness and plate_radius")
    if pair is not None and "contact_stiffness" in parameters:
        raise ValueError("contact_stiffness and materials state the same: leave one out")
    if "restitution" in given and "contact_damping" in parameters:
        raise ValueError("contact_damping and restitution state the same: leave one out")
    if "restitution" in given:
        needed = {n: parameters.get(n, 0.0) for n in ("half_width", "clearance", "mass", "inertia")}
        if {"misalignment", "half_height"} <= parameters.keys():
            needed["misalignment"] = middle_of_face(parameters)
        for name, value in needed.items():
            if not value > 0.0:
                raise ValueError(f"restitution needs {name}, a number > 0")
