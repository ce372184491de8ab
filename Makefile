# loadshare: `make help` lists what can be done.
PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
CASE   ?= cases/fgfbstts/limit_ring.toml
WORKERS ?= 2
# Of tests one more than there are cores: some wait for a browser or for another process.
TESTERS ?= 3
# BLAS gains nothing on matrices of this size, and its threads fight with the test workers.
export OPENBLAS_NUM_THREADS = 1
# Without bytecode on disk every process would compile all modules again.
export PYTHONDONTWRITEBYTECODE =
export NO_MKDOCS_2_WARNING = 1

.DEFAULT_GOAL := help
.PHONY: help run test test-all test-lowest test-shuffled lint format types layers docs docs-serve kernels cases \
	bench stress reproduce fuzz fuzz-guided kills dist clean

help: ## list the targets
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | awk -F':.*## ' '{printf "  %-12s %s\n", $$1, $$2}'

$(VENV)/.run: pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e .
	@touch $@

$(VENV)/.dev: pyproject.toml constraints.txt
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[dev]'
	@touch $(VENV)/.run $@

run: $(VENV)/.run ## run the main job (CASE=cases/… for another case)
	$(BIN)/loadshare run $(CASE)

$(VENV)/.bench: $(VENV)/.run
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[bench]'
	@touch $@

# All that a test runs against, side by side; the tests find the kernels on disk.
CHECKED := $(MAKE) --no-print-directory --output-sync -j $(WORKERS) kernels types docs lint layers
# Neighbours stay together, so that a file's fixtures are made once; the pages are those just built.
TESTED := LOADSHARE_SITE=site $(BIN)/python -m pytest -n $(TESTERS) --dist worksteal

test: $(VENV)/.dev ## check and test everything that is not slow
	$(CHECKED)
	$(TESTED) -m "not slow"

test-all: $(VENV)/.dev ## the same with the slow tests
	$(CHECKED)
	$(TESTED)

LOWEST := .venv-lowest
$(LOWEST)/.test: pyproject.toml constraints-lowest.txt
	$(PYTHON) -m venv $(LOWEST)
	$(LOWEST)/bin/python -m pip install --quiet --disable-pip-version-check -c constraints-lowest.txt -e '.[test]'
	@touch $@

test-lowest: $(LOWEST)/.test ## test with the lowest versions that are allowed
	$(LOWEST)/bin/python -m pytest -n $(TESTERS) -m "not slow" tests/case tests/cli tests/physics tests/results \
		tests/study/test_commands.py tests/tooth/use tests/report/test_save.py tests/surroundings

SEED ?= 1
test-shuffled: $(VENV)/.dev ## the tests in a random order (SEED=…)
	$(BIN)/python -m pytest -n $(TESTERS) -m "not slow" --shuffle $(SEED)

lint: $(VENV)/.dev ## ruff: style and formatting
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

format: $(VENV)/.dev ## rewrite the sources in the one format
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

types: $(VENV)/.dev ## mypy, strict
	$(BIN)/mypy

layers: $(VENV)/.dev ## data flows one way (import-linter)
	$(BIN)/lint-imports

kernels: $(VENV)/.run ## compile what is compiled, where it is not on disk yet
	$(BIN)/loadshare warm

docs: $(VENV)/.dev ## build the documentation, strict
	$(BIN)/mkdocs build --strict --quiet

docs-serve: $(VENV)/.dev ## serve the documentation while writing
	$(BIN)/mkdocs serve

cases: $(VENV)/.run ## write the generated cases again
	$(BIN)/python -m benchmarks.families cases

bench: $(VENV)/.bench ## measure speed against accuracy (docs/evidence)
	$(BIN)/python -m benchmarks.chart

stress: $(VENV)/.bench ## try every method on every family (docs/evidence)
	$(BIN)/python -m benchmarks.stress

reproduce: $(VENV)/.run ## compute the seed paper's figures (docs/reproduction.md)
	$(BIN)/python -m benchmarks.reproduction

N ?= 10000
fuzz: $(VENV)/.dev ## try N unintended inputs: no traceback, no hang, no wrong figure
	$(BIN)/python -m tests.fuzz --count $(N) --processes $(WORKERS)

$(VENV)/.fuzz: $(VENV)/.dev
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[fuzz]'
	@touch $@

SECONDS ?= 600
FOUND ?= build/fuzz
fuzz-guided: $(VENV)/.fuzz ## for SECONDS, change the cases that reach new lines (Linux)
	$(BIN)/python -m tests.fuzz.guided $(FOUND) -max_total_time=$(SECONDS)

KILLS ?= 200
kills: $(VENV)/.dev ## kill batches and studies KILLS times: nothing left, and the same results after
	$(BIN)/python -m tests.kills --count $(KILLS)

$(VENV)/.release: $(VENV)/.run
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[release]'
	@touch $@

TAG ?=
dist: $(VENV)/.release ## build wheel and sdist, check them, install and run each
	rm -rf dist
	$(BIN)/python -m build --outdir dist
	$(BIN)/twine check --strict dist/*
	$(BIN)/python -m tests.surroundings.distribution dist --tag "$(TAG)"

clean: ## remove what was built
	rm -rf $(VENV) $(LOWEST) site dist build .pytest_cache .mypy_cache .ruff_cache
