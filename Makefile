# Two commands do all the set-up on a fresh machine: `make demo` and `make test`.

PYTHON ?= python3
export PIP_DISABLE_PIP_VERSION_CHECK = 1
# Nothing else stops a dependency from pulling another torch, with gigabytes of CUDA.
export PIP_CONSTRAINT = $(CURDIR)/constraints.txt

DEMO = .demo-venv
VENV = .venv
PEERS = .peers-venv
STITCHERS = .stitchers-venv
TESTS ?= tests
MODEL ?= expand-2
WORK ?= work
SIZE ?= pocket
BIN = $(VENV)/bin

.PHONY: help demo test check test-slow test-browser bench bench-report bench-library bench-peers bench-stitchers bench-qa bench-dataset bench-engine slurm-test expansion-table bench-lighting lighting-suite docs clean

help:
	@echo "make demo       light probes from the embedded city, with a report (core packages only)"
	@echo "make test       the test suite, in an environment of its own"
	@echo "make check      style, types and layers"
	@echo "make test-slow  tests that take minutes"
	@echo "make test-browser  the report and the application in a headless Chromium (needs Chromium)"
	@echo "make bench      benchmarks"
	@echo "make bench-report  a report of 200 probes: its size, and how soon it is open (needs PANOKIT_DATA)"
	@echo "make bench-library  a library of 10,000 probes: listing, filters, indexing"
	@echo "make bench-peers  geometry against skylibs, equilib and py360convert"
	@echo "make bench-dataset  CPU time of dataset samples, and Mitsuba beside Cycles (needs PANOKIT_DATA)"
	@echo "make bench-lighting  the reflectance operator beside the thesis's; comparing views, loading, latency"
	@echo "make bench-qa   how often QA sees deliberate damage (needs PANOKIT_DATA)"
	@echo "make bench-engine  what engines cost: overhead, idle cores, memory per worker"
	@echo "make slurm-test a pipeline on a real Slurm with a job killed (needs root and Debian's slurm)"
	@echo "make bench-stitchers  stitching against OpenCV, OpenStitching, Hugin (needs PANOKIT_DATA)"
	@echo "make expansion-table  expansion methods on probes none has seen (needs PANOKIT_DATA; hours)"
	@echo "make lighting-suite SIZE=pocket DATA=stereo-10k  all experiments on light, trained and judged"
	@echo "make docs       the documentation, in docs/_build"

demo: $(DEMO)/.installed
	$(DEMO)/bin/panokit demo --out demo

test: $(VENV)/.installed
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -n auto -m "not slow and not browser" --ignore=tests/benchmarks $(TESTS)

check: $(VENV)/.installed
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports

test-slow: $(VENV)/.installed
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -m "slow" $(TESTS)

test-browser: $(VENV)/.installed
	$(BIN)/pip install --quiet -e ".[browser]"
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -m browser tests/browser

bench-report: $(VENV)/.installed
	$(BIN)/pip install --quiet -e ".[browser]"
	$(BIN)/python tests/benchmarks/report.py $(PANOKIT_DATA)

bench: $(VENV)/.installed
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest tests/benchmarks --benchmark-columns=min,mean,rounds

bench-library: $(VENV)/.installed
	OMP_NUM_THREADS=1 $(BIN)/python tests/benchmarks/library.py

bench-peers: $(VENV)/.installed $(PEERS)/.installed
	OMP_NUM_THREADS=1 $(BIN)/python tests/benchmarks/peers/compare.py $(PEERS)/bin/python

bench-dataset: $(VENV)/.installed
	$(BIN)/python tests/benchmarks/dataset_render.py $(PANOKIT_DATA)

# With DATA=DATASET the loading of batches is measured too.
bench-lighting: $(VENV)/.installed
	$(BIN)/python tests/benchmarks/reflectance.py
	$(BIN)/python tests/benchmarks/lighting.py $(if $(DATA),--data $(DATA)) --work $(WORK)

bench-qa: $(VENV)/.installed
	$(BIN)/python tests/benchmarks/qa_damage.py $(PANOKIT_DATA)

bench-engine: $(VENV)/.installed
	OMP_NUM_THREADS=1 $(BIN)/python tests/benchmarks/engine_overhead.py

# Exit code 77: there is no Slurm here, and it said what to install.
slurm-test: $(VENV)/.installed
	$(BIN)/pip install --quiet -e ".[slurm]"
	OMP_NUM_THREADS=1 tests/slurm/run.sh $(CURDIR)/$(BIN)/panokit || test $$? -eq 77

bench-stitchers: $(VENV)/.installed $(STITCHERS)/.installed
	$(BIN)/python tests/benchmarks/peers/compare_stitching.py $(PANOKIT_DATA) $(STITCHERS)/bin/python

# What is done is kept in WORK: stop it and start it again.
expansion-table: $(VENV)/.installed
	@test -d "$(PANOKIT_DATA)/probes" || { echo "Set PANOKIT_DATA to the folder that holds probes/."; exit 2; }
	$(BIN)/panokit train models/$(MODEL)/recipe.toml --probes $(PANOKIT_DATA)/probes --work $(WORK) --folds --fold-members 2
	$(BIN)/panokit train models/expandnet/expandnet.toml --probes $(PANOKIT_DATA)/probes --work $(WORK) --folds
	OMP_NUM_THREADS=1 $(BIN)/panokit evaluate expansion --probes $(PANOKIT_DATA)/probes --out $(WORK)/scores \
		--model '$(WORK)/$(MODEL)/fold-{fold}' --peer '$(WORK)/expandnet/fold-{fold}/expandnet.onnx'

# Exit code 1 says that some networks are missing, such as those whose own datasets are not there;
# the others are judged all the same.
lighting-suite: $(VENV)/.installed
	@test -d "$(DATA)" || { echo "Set DATA to a stereo dataset, see docs/guides/stereo-dataset.md."; exit 2; }
	$(BIN)/panokit train pipelines/lighting --size $(SIZE) --data $(DATA) --work $(WORK) || test $$? -eq 1
	$(BIN)/panokit evaluate $(WORK)/models --data $(DATA) --out $(WORK)/scores

docs: $(VENV)/.installed
	$(BIN)/pip install --quiet -e ".[docs]"
	$(BIN)/python -m sphinx -W -b html docs docs/_build/html

$(DEMO)/.installed: pyproject.toml constraints.txt
	$(PYTHON) -m venv $(DEMO)
	$(DEMO)/bin/pip install --quiet -e .
	touch $@

# Peers live apart: some of them pull packages that must never meet ours.
$(PEERS)/.installed: tests/benchmarks/peers/requirements.txt constraints.txt
	$(PYTHON) -m venv $(PEERS)
	$(PEERS)/bin/pip install --quiet -r tests/benchmarks/peers/requirements.txt
	touch $@

$(STITCHERS)/.installed: tests/benchmarks/peers/requirements-stitching.txt
	$(PYTHON) -m venv $(STITCHERS)
	$(STITCHERS)/bin/pip install --quiet -r tests/benchmarks/peers/requirements-stitching.txt
	touch $@

$(VENV)/.installed: pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet -e ".[train,render,cities,app,dev]"
	touch $@

clean:
	rm -rf $(DEMO) $(VENV) $(PEERS) $(STITCHERS) demo docs/_build .pytest_cache .mypy_cache .ruff_cache
