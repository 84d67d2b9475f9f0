"""Random sets over the whole domain of the parameters: `make fuzz`, apart from the study."""

from verification.fuzz_campaign import HOLDS

fuzz = study.accuracy.fuzz
fuzz_parts = range(-(-fuzz.sets // fuzz.sets_a_job))
fuzz_folder = root / f"accuracy/fuzz/{fuzz.scene}/{fuzz.sets_a_job}"
fuzz_text = root / f"accuracy/fuzz_{fuzz.scene}.txt"


def first_of(wildcards):
    """Return the number of the first set of a part."""
    return int(wildcards.chunk) * fuzz.sets_a_job


# More sets add parts: those that are there stay.
job(
    "fuzz_part",
    dict(found=fuzz_folder / "{chunk}.json"),
    after_kernels,
    dict(
        scene=fuzz.scene,
        seed=fuzz.seed,
        first=first_of,
        count=lambda wildcards: min(fuzz.sets_a_job, fuzz.sets - first_of(wildcards)),
    ),
    message="fuzz: trying part {wildcards.chunk}",
)

job(
    "fuzz_summary",
    dict(text=fuzz_text),
    dict(parts=expand(fuzz_folder / "{n}.json", n=fuzz_parts)),
    dict(scene=fuzz.scene, seed=fuzz.seed),
    message="fuzz: adding up its parts",
    local=True,
)

printed("fuzz", fuzz_text, "the result of the fuzz", must_end=HOLDS)
