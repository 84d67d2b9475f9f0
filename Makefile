# make            the environment and every result of the study: `snakemake -c2`; also to restart with
# make fig06      one figure
# make smoke      the same study, small, into its own results root
# make test       the environment, every check and every test
# make maps       the stability maps that the paper does not have
# make accuracy   the integrator's errors on thousands of random sets: printed, and results/accuracy
# make identification  the searches for the device, from nothing: some minutes each
# make null       random devices drawn anew: after priors, ledger, physics or their grid have changed
# make fuzz       random sets over the whole domain of the parameters; SETS=1000000 for a million, to
#                 which finished parts count; SCENE=insertion for devices that fall in
# make truth-round  the table of round pegs, in three dimensions, in the environment of `make bench`: an hour
# make bench      speed against other integrators, in an environment of its own (about 15 minutes);
#                 BENCH_FLAGS=--quick for a rough table in three
# make nightly    tests that take long: 50 kills, full disks, mutations, the smoke study in two folders
#                 at one and at two cores (STUDY=full: the whole study), types of the explorer's scripts
# make slurm-test  the study on a Slurm of its own, from Debian's packages: kills, cancels, limits
# make browser-test  the explorer in a headless Chromium
# make docs       the documentation as a site in site/, to be read without network: site/index.html
# make lock       requirements*.lock anew; LOCK_FLAGS=--upgrade takes newer versions
# make clean      deletes everything generated, results included; `make distclean` the environments too
#
# PYTHON=python3.13 is the Python to build the environment with, CORES=8 the number of cores,
# SNAKEMAKE_FLAGS=... adds options to every run of the study; PROFILE=slurm runs its jobs on a cluster.

PYTHON ?= python3
CORES ?= 2
SNAKEMAKE_FLAGS ?=
PROFILE ?= default
BENCH_FLAGS ?=
UV_VERSION := 0.13.8

SHELL := /bin/sh
.DEFAULT_GOAL := all
.DELETE_ON_ERROR:

# Commands find the tools of the environment first, and nothing of the caller's Python. PATH is not set
# for the whole file, because PYTHON is looked up outside the environment. Bytecode is kept, because
# some hundred processes import the package, each half a second faster.
in_env := PATH="$(CURDIR)/.venv/bin:$$PATH"
ifneq ($(PROFILE),slurm)
cores_of_study := -c$(CORES)
endif
unexport PYTHONHOME PYTHONPATH PYTHONDONTWRITEBYTECODE

.PHONY: all smoke maps accuracy identification null fuzz
.PHONY: test lint types layers workflow unit environment environment-bench python lock
.PHONY: truth-round bench nightly script-types browser-test slurm-test docs
.PHONY: clean distclean

# --------------------------------------------------------------------------------------- the study

# $(call run_study,OPTIONS AND TARGETS). The caller's options come last, because an option with several
# values would take targets after it for values.
run_study = $(in_env) snakemake $(1) --workflow-profile profiles/$(PROFILE) $(cores_of_study) $(SNAKEMAKE_FLAGS)

all: environment
	$(call run_study,)

fig%: environment
	$(call run_study,$@)

smoke: environment
	$(call run_study,--configfile config/smoke.yaml)

maps: environment
	$(call run_study,maps)

accuracy: environment
	$(call run_study,accuracy)

identification: environment
	$(call run_study,identification)

null: environment
	$(call run_study,null)

SETS ?= 10000
SCENE ?= alignment
fuzzed = '{"fuzz":{"sets":$(SETS),"scene":"$(SCENE)"}}'# its comma would end an argument of call
fuzz: environment
	$(call run_study,fuzz --config accuracy=$(fuzzed))

# --------------------------------------------------------------------------------------- the checks

check = @echo "--- $(1)"; $(in_env) $(1)

# In parallel, because the tests begin with the compilation of the kernels, which takes one core.
test: environment
	@$(MAKE) --no-print-directory -j$(CORES) lint types layers workflow unit

lint: environment
	$(call check,ruff check .)
	$(call check,ruff format --check .)
	$(call check,codespell)

types: environment
	$(call check,mypy)

layers: environment
	$(call check,lint-imports)

workflow: environment
	$(call check,snakefmt --check Snakefile workflow)

unit: environment
	$(call check,pytest --numprocesses $(CORES) --dist loadfile --no-loadscope-reorder)

browser-test: environment
	$(call check,pytest -m browser -rs tests/vibralign/explorer)

# Checks the explorer's scripts for types, from their comments, and unused names; npm fetches TypeScript.
script-types:
	@command -v npx >/dev/null || echo "no npx here: the types of the explorer's scripts are not checked"
	! command -v npx >/dev/null || npx --yes --package typescript@5.9.3 tsc --noEmit --strict --noUnusedLocals --noUnusedParameters --noImplicitReturns --checkJs --allowJs --target es2022 \
		--lib es2022,dom,dom.iterable src/vibralign/explorer/*.js

# On a Slurm of its own.
slurm-test: environment
	$(in_env) pytest -rPs -m nightly tests/workflow/test_slurm.py

docs: environment
	rm -rf site docs/examples
	$(in_env) sphinx-build --fresh-env --fail-on-warning --keep-going --quiet docs site
	$(in_env) python docs/extensions/links.py site
	@echo "open site/index.html"

# KILLS=500 kills the study at more moments.
STUDY ?= smoke
KILLS ?= 50
nightly: environment
	VIBRALIGN_STUDY=$(STUDY) VIBRALIGN_KILLS=$(KILLS) VIBRALIGN_SETS=500 $(in_env) pytest -rP -m nightly tests
	@$(MAKE) --no-print-directory script-types

# ------------------------------------------------------------------------------------ the benchmark

# PYTHONPATH in place of an installation: the environment has no vibralign.
bench: environment-bench
	PYTHONPATH=src .venv-bench/bin/python -m verification.bench $(BENCH_FLAGS)

# The table of round pegs against a reference in three dimensions, which `make test` reads: an hour;
# ROUND_FLAGS="--points 2 3" for some of its rows.
ROUND_FLAGS ?=
truth-round: environment-bench
	PYTHONPATH=src .venv-bench/bin/python -m verification.round.table $(ROUND_FLAGS)

# ---------------------------------------------------------------------------------- the environment

# An environment is built from nothing when its lock file, pyproject.toml or the version of Python
# changes. The stamp is written last, so that an interrupted build is done again.
TAG := $(shell $(PYTHON) -c 'import sys; print("%d.%d.%d" % sys.version_info[:3])' 2>/dev/null)

# One make builds at a time, under a lock that the system releases with the process; another says so,
# waits, and then finds the environment complete.
locked = $(PYTHON) -c 'import fcntl, os, signal, sys; \
	words = "another make builds the environment here: waiting until it is complete"; \
	signal.signal(signal.SIGALRM, lambda *_: print(words, file=sys.stderr)); signal.alarm(1); \
	lock = os.open(".make-environment.lock", os.O_RDWR | os.O_CREAT, 0o644); \
	fcntl.flock(lock, fcntl.LOCK_EX); signal.alarm(0); os.set_inheritable(lock, True); \
	os.execvp(sys.argv[1], sys.argv[1:])'

environment: python
	@$(locked) $(MAKE) --silent --no-print-directory .venv/.complete-$(TAG)

environment-bench: python
	@$(locked) $(MAKE) --silent --no-print-directory .venv-bench/.complete-$(TAG)

# The environment of the study, with this package in editable form.
.venv/.complete-$(TAG): requirements.lock pyproject.toml
	$(call build,.venv,$<)
	@$(call pip_of,.venv); \
	$$pip install --quiet --no-deps --no-build-isolation --editable . && $$pip check
	@touch $@

# The peers of `make bench`, without this package. The benchmark reports peers that are missing.
.venv-bench/.complete-$(TAG): requirements-bench.lock
	$(call build,.venv-bench,$<)
	@touch $@

# $(call pip_of,FOLDER) begins a shell line and sets `pip` for the environment. Where Python comes
# without ensurepip, the system's pip is used.
pip_of = pip="$(PYTHON) -m pip --python $(1)/bin/python"; \
	if [ -x $(1)/bin/pip ]; then pip="$(1)/bin/python -m pip"; fi; \
	export PIP_DISABLE_PIP_VERSION_CHECK=1
pinned := --quiet --no-deps --use-pep517 --require-hashes --requirement

# $(call build,FOLDER,LOCK FILE): a new environment with the pinned packages.
define build
@echo "building the environment in $(1) with Python $(TAG)"
@$(PYTHON) -m venv --clear $(1) >/dev/null 2>&1 || $(PYTHON) -m venv --clear --without-pip $(1)
@$(call pip_of,$(1)); $$pip install $(pinned) $(2)
endef

python:
	@command -v $(PYTHON) >/dev/null || { \
		echo "no $(PYTHON) here; name a Python of 3.11 or newer: make PYTHON=..." >&2; exit 1; }
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
		echo "$(PYTHON) is Python $(TAG), vibralign needs 3.11 or newer: make PYTHON=..." >&2; exit 1; }

# Pins what the wheel needs and the groups, with the hashes of all platforms, for Python 3.11 and newer.
# Packages that the study and the peers of `make bench` share have the study's versions. `fewest`
# takes one version of a package for all Pythons.
lock: python
	$(PYTHON) -m venv --clear .lock-venv
	.lock-venv/bin/python -m pip install --quiet uv==$(UV_VERSION)
	$(call pin,requirements.lock,--group study --group slurm --group docs --group dev)
	$(call pin,requirements-bench.lock,--group bench --constraints requirements.lock)
	rm -rf .lock-venv

# $(call pin,LOCK FILE,GROUPS AND OPTIONS)
pin = UV_CUSTOM_COMPILE_COMMAND="make lock" .lock-venv/bin/uv pip compile pyproject.toml \
	--quiet $(2) --universal --python-version 3.11 --fork-strategy fewest \
	--generate-hashes --no-config --no-annotate $(LOCK_FLAGS) --output-file $(1)

clean:
	@$(PYTHON) -c 'import fcntl, glob; \
		[fcntl.flock(open(lock), fcntl.LOCK_SH | fcntl.LOCK_NB) \
		for lock in glob.glob("results*/history/lock")]' 2>/dev/null || { \
		echo "another start builds results here now: wait until it ends, or stop it" >&2; exit 1; }
	find results -mindepth 1 ! -name README.md -delete
	rm -rf results-* .snakemake build dist site docs/examples
	rm -rf .hypothesis .import_linter_cache .mypy_cache .pytest_cache .ruff_cache

distclean: clean
	rm -rf .venv .venv-* .lock-venv .make-*.lock
