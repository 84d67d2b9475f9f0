"""Definition of rules: the directives that all jobs share are stated here only."""

import hashlib
import json
import re
from pathlib import Path

from model.tracking.provenance import announce, code_hash


def pictures(place):
    """Return the files of a picture from its path without suffix, the PNG first."""
    return [f"{place}{suffix}" for suffix in (".png", ".svg", ".pdf")]


def by_name(files):
    """Return a rule's files by name as JSON has them, without those that a job does not open."""
    opened = ((name, each) for name, each in files.items() if name not in ("after", "record"))
    return {name: each if isinstance(each, str) else list(each) for name, each in opened}


codes = {}  # of every job, by its name
study_hash = hashlib.sha256(study.model_dump_json().encode()).hexdigest()[:16]


def code(name):
    """Return the hash of what a job runs: an edit reruns exactly what depends on it."""
    sources = ("workflow/run.py", f"workflow/jobs/{name}.py")
    codes[name] = code_hash(Path(workflow.basedir), *sources)
    return codes[name]


def job(
    name,
    outputs,
    inputs={},
    params={},
    *,
    message,
    wildcards={},
    runs=None,
    run=None,
    record=None,
    minutes=10,
    mem_mb=2000,
    local=False,
    reported=None,
    priority=0,
):
    """Define the rule of a job, which calls the function in jobs/NAME.py.

    The function's arguments are the rule's outputs, inputs and params by their names.

    Args:
        name: the rule's name.
        outputs: a path, or a list of them, by name.
        inputs: as outputs, or functions of the wildcards. Those named ``after`` are waited for and
            not opened by the job.
        params: values, or functions of the wildcards. Models of the study become JSON objects.
        message: printed when the job starts.
        wildcards: regular expressions of wildcards, by name.
        runs: the job's file in jobs/, where it is not NAME.
        run: the run's name, and that of its log; else NAME and the output's wildcards in order.
        record: the sidecar, if it is not beside the first output; "" for none.
        minutes: time limit on a cluster, at least five times the time of the full study. Every
            further attempt has twice the time and the memory.
        mem_mb: memory on a cluster, in MB, at least twice the greatest of the full study.
        local: run beside Snakemake on a cluster, too: of jobs that draw, merge or index.
        priority: of jobs that may run; the longest jobs and chains have the highest, to end with the
            others.
        reported: category and caption (in workflow/report/) of the first output in
            `snakemake --report`.
    """
    runs = runs or name
    first = next(iter(outputs.values()))
    first = first[0] if isinstance(first, list) else first
    run = run or Path(name, *re.findall(r"{\w+}", str(first))).as_posix()
    if reported:
        shown = report(str(first), caption=f"../report/{reported[1]}.rst", category=reported[0])
        key, files_of_first = next(iter(outputs.items()))
        rest = files_of_first[1:] if isinstance(files_of_first, list) else None
        outputs = {**outputs, key: shown if rest is None else [shown, *rest]}
    if record is None:
        record = Path(first).with_suffix(".run.json")

    # Apart from the files: Snakemake does not compare params that are made from input or output.
    def request(wildcards):
        asked = {
            "job": runs,
            "run": run.format(**wildcards),
            "record": str(record).format(**wildcards),
            "params": {k: v(wildcards) if callable(v) else v for k, v in params.items()},
        }
        return json.dumps(asked, default=lambda model: model.model_dump(mode="json"))

    def files(wildcards, input, output):
        named = {"inputs": by_name(input), "outputs": by_name(output)}
        return json.dumps({**named, "study": study_hash})

    rule:
        name:
            name
        input:
            **inputs,
        output:
            **outputs,
            **({"record": record} if record else {}),
        log:
            root / f"logs/{run}.log",
        wildcard_constraints:
            **wildcards,
        priority: priority
        localrule: local
        threads: 1
        resources:
            runtime=lambda wildcards, attempt: minutes * 2 ** (attempt - 1),
            mem_mb=lambda wildcards, attempt: mem_mb * 2 ** (attempt - 1),
        params:
            code=code(runs),
            request=request,
            files=files,
        message:
            message
        shell:
            "python workflow/run.py {params.request:q} {params.files:q} > {log} 2>&1"


def printed(name, text, message, must_end=""):
    """Define the rule that prints a file, also where nothing had to be computed for it.

    It fails if the last line of the file is not ``must_end``, where that is given.
    """

    rule:
        name:
            name
        input:
            text,
        log:
            root / f"logs/{name}.log",
        localrule: True
        params:
            must_end=must_end,
        message:
            message
        shell:
            'cat {input} | tee {log}; tail -n 1 {input} | grep -q -e "{params.must_end}"'
