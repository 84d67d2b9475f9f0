"""Render the report: one page with every figure, its caption, parameters and outcomes."""

import argparse
from pathlib import Path

from model.show.claims import Ledger
from model.show.contact_stiffness import Bases
from model.show.hard_cases import Hardness
from model.show.identification import Pictured
from model.show.precision import Comparison
from model.show.report import Findings, render_report
from model.study.claims.table import read_ledger
from model.study.config import FIGURES, SCHEMATICS, Study
from model.study.datasets import read_dataset
from model.study.hard_cases import read_table
from model.study.identification.committed import PICTURES as IDENTIFIED_PICTURES
from model.study.identification.committed import read_identified
from model.study.precision import read_timings
from model.study.precision_plans import HARD_PICTURES, PICTURES
from model.tracking.provenance import Job, file_hash, versions, write_text


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--study", required=True, type=Study.model_validate_json)
    parser.add_argument("--root", required=True, type=Path)
    parser.add_argument("--identified", type=Path, nargs="*", default=[], help="its tables")
    parser.add_argument("--output", required=True, type=Path)
    parser.add_argument("--record", required=True, type=Path)
    arguments = parser.parse_args()
    root: Path = arguments.root
    study: Study = arguments.study
    job = Job("report")
    computed = [name for name in FIGURES if name not in SCHEMATICS]
    data = {name: root / f"data/{name}.nc" for name in computed}
    pictures = {name: root / f"figures/{name}.png" for name in FIGURES}
    times = root / "benchmarks/precision.csv"
    wrong = {
        name: root / f"data/fixed_steps/{name}.nc" for name in study.precision.fixed_steps.figures
    }
    compared = {name: root / f"{place}.png" for name, place in PICTURES.items()}
    comparison = Comparison(
        rungs=read_timings(times),
        wrong={name: read_dataset(path) for name, path in wrong.items()},
        pictures=compared,
    )
    ledger = Ledger(read_ledger(root / "claims.csv"), root / "figures/claims.png")
    on_bases = {
        name: root / f"data/contact_stiffness/{name}.nc" for name in study.contact_stiffness.figures
    }
    bases = Bases(
        {name: read_dataset(path) for name, path in on_bases.items()},
        root / "figures/contact_stiffness.png",
    )
    judged = root / "benchmarks/hard_cases.csv"
    hard = {name: root / f"{place}.png" for name, place in HARD_PICTURES.items()}
    read = [*data.values(), *wrong.values(), *on_bases.values(), times, judged]
    read.append(root / "claims.csv")
    identified = None
    if arguments.identified:
        identified = Pictured(
            read_identified(arguments.identified[0].parent),
            {name: root / f"{place}.png" for name, place in IDENTIFIED_PICTURES.items()},
        )
    # Nothing of the day, the machine or the checkout, so that the same data give the same bytes.
    provenance = {
        "made with": versions(),
        "from": {path.relative_to(root).as_posix(): file_hash(path)[:16] for path in read},
        "when, where, at which commit": "runs.csv and history/ beside this page; vibralign runs",
    }
    findings = Findings(
        datasets={name: read_dataset(path) for name, path in data.items()},
        figures=pictures,
        comparison=comparison,
        ledger=ledger,
        bases=bases,
        hardness=Hardness(read_table(judged), hard),
        identified=identified,
    )
    write_text(render_report(study, findings, provenance), arguments.output)
    shown = [*pictures.values(), *compared.values(), ledger.picture, bases.picture, *hard.values()]
    shown += [*identified.pictures.values(), *arguments.identified] if identified else []
    job.finish(arguments.record, [arguments.output], [*read, *shown])


if __name__ == "__main__":
    main()
