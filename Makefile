# Each target builds what it needs in .venv, from nothing but Python 3.11 or newer. With another Python, beside it:
# make test PYTHON=python3.13 VENV=.venv-3.13
PYTHON ?= python3
VENV := .venv
# The wheels of ROS 2 that tests compare with: a group in pyproject.toml.
REFERENCE := reference
BIN := $(VENV)/bin
# Further options of pytest, for each of its sessions: make test WITH="-x".
WITH :=
PYTEST := $(BIN)/pytest $(WITH)
TYPED := codegen/ifgen codegen/ifgen_generators codegen/ifgen_runtime codegen/packaging codegen/runtime
# Tests that the codec in C and the generated functions must pass alike: `make test` runs them with each, the longest first.
# Tests that use rclpy in their own process: one session for each rclpy.
# Those of rclpy have one of their own, because nodes that they maltreat may outlive a test.
INSIDE := $(filter-out tests/rclpy/inside,$(wildcard tests/*/inside tests/*/*/inside))
BOTH_CODECS := $(addprefix tests/,against_rosidl/test_classes.py \
	$(addprefix codec/test_,$(addsuffix .py,hostile_input large refusals round_trip views wire)) runtime/test_message_classes.py)
# The packages that nodes import besides rclpy.
LIBRARIES := $(patsubst codegen/libraries/%/__init__.py,%,$(wildcard codegen/libraries/*/__init__.py))
CASES := 1000000
TEST_MSGS := generated/test_msgs/.ifgen-manifest.json
# Whether pictures can be drawn here: the demo does without them where there is no OpenGL.
CAN_DRAW = PYTHONPATH=examples/humanoid $(BIN)/python -c \
	'from humanoid.simulation.rendering import check; check()' 2>/dev/null
EMPTY :=
# The folders of generated packages of nodes, with colons between them.
NODES := $(subst $(EMPTY) $(EMPTY),:,$(patsubst %/setup.py,%,$(wildcard generated/*/setup.py)))

# Tests start hundreds of interpreters. Compiling the same modules in each would take half of the time.
unexport PYTHONDONTWRITEBYTECODE
export PYTHONPYCACHEPREFIX := $(abspath $(VENV))/pycache

.DEFAULT_GOAL := help
.PHONY: help demo test test-slow test-kilted interop fuzz lint bench dist clean

help:  ## list these targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "make %-11s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

demo: $(VENV)/.run  ## see ifgen work on real interfaces, and a humanoid that walks with them
	@$(BIN)/python examples/first_steps.py
	@echo
	@$(BIN)/ifgen demo --scenario walk $$($(CAN_DRAW) && echo --record $(VENV)/humanoid.png)
	@echo
	@echo "To play with the robot in the browser: $(BIN)/ifgen demo --web"

test: $(VENV)/.test  ## run the tests (on Linux x86_64 against real ROS 2 as well)
	$(PYTEST) -n auto --dist worksteal -m "not slow and not alone"
	IFGEN_CODEC=python $(PYTEST) -n auto --dist worksteal -m "not slow and not alone" $(BOTH_CODECS)
	$(PYTEST) -n auto --dist worksteal --transport local -m "not slow and not alone" tests/rclpy/inside
	$(PYTEST) -n auto --dist worksteal --transport local -m "not slow and not alone" $(INSIDE)
	$(PYTEST) -n auto --transport both generated tests/libraries/inside/test_filters.py

test-slow: $(VENV)/.test  ## run the tests that take longer
	$(PYTEST) -n auto --dist worksteal -m "slow and not alone"
	$(PYTEST) -n auto --dist worksteal --transport local -m "slow and not alone" tests/rclpy/inside
	$(PYTEST) -n auto --dist worksteal --transport local -m "slow and not alone" $(INSIDE)
	IFGEN_CODEC=python IFGEN_CASES=400 $(PYTEST) -n auto --transport local $(addprefix tests/rclpy/inside/,\
		mismatched_topics test_mismatch_services.py test_hostile_bytes.py)
	$(PYTEST) -n auto --dist worksteal --transport both tests/libraries/inside
	$(PYTEST) -m alone

test-kilted:  ## run the tests of real rclpy on ROS 2 Kilted, in its own environment
	@$(MAKE) --no-print-directory VENV=$(VENV)-kilted REFERENCE=reference-kilted $(VENV)-kilted/.test
	$(VENV)-kilted/bin/pytest $(WITH) -n auto -m "not alone" tests/native tests/against_rclpy/test_api_coverage.py
	$(VENV)-kilted/bin/pytest $(WITH) -n auto --transport rclpy generated tests/libraries/inside/aio

interop: $(VENV)/.test  ## meet other implementations of rmw_zenoh's conventions and of DDS (INSTALL=1 first, about 1 GB)
	$(BIN)/python -m tests.interop.bench $(if $(INSTALL),--install) $(OPTIONS)

fuzz: $(VENV)/.test  ## compare the codecs on mutated input (CASES=10000000, SANITIZE=1)
	$(BIN)/python -m tests.codec.fuzzing --cases $(CASES) $(if $(SANITIZE),--sanitize)

lint: $(VENV)/.test  ## check style, types, imports between rooms, and that generated/ is up to date
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy $(TYPED)
	MYPYPATH=codegen/underlay:codegen/libraries $(BIN)/mypy -p rclpy -p rmw_local -p ifgen_pytest -p ifgen_tools
	MYPYPATH=codegen/underlay:codegen/libraries $(BIN)/mypy $(addprefix -p ,$(LIBRARIES))
	MYPYPATH=codegen/underlay:examples/humanoid:$(NODES) $(BIN)/mypy -p humanoid
	$(BIN)/pyright
	PYTHONPATH=codegen/underlay:codegen/libraries:examples/humanoid $(BIN)/lint-imports
	$(BIN)/ifgen generate --check

bench: $(VENV)/.test  ## measure, and write docs/benchmarks.md
	$(BIN)/python -m pip install --quiet --group bench
	$(BIN)/python benchmarks/run.py

dist: $(VENV)/.run  ## build sdists and wheels into dist/, and check them
	$(BIN)/python -m pip install --quiet --group dist
	$(BIN)/python .ci/make_dist.py dist

clean:  ## remove everything that the other targets built
	rm -rf $(VENV) $(VENV)-* dist build .mypy_cache .ruff_cache .pytest_cache .hypothesis

# The stamps lie in .venv, so that removing it resets them.
$(VENV)/.run: pyproject.toml $(wildcard codegen/*/pyproject.toml) .ci/make_venv.py
	$(PYTHON) .ci/make_venv.py $(VENV)
	$(BIN)/python -m pip install --quiet --editable codegen/runtime --editable '.[sim]'
	@touch $@

$(VENV)/.test: $(VENV)/.run $(VENV)/.native | $(TEST_MSGS)
	$(BIN)/python -m pip install --quiet --editable codegen/runtime --editable '.[sim,tools]' --group dev --group $(REFERENCE)
	@touch $@

# Messages that only tests need: not committed, and in no wheel.
$(TEST_MSGS): $(wildcard interfaces/test_msgs/*/*) | $(VENV)/.run
	$(BIN)/ifgen generate --quiet interfaces/test_msgs
	@touch $@

# The type support for real rclpy: C, so only where there is a compiler, and a ROS to use it with.
$(VENV)/.native: $(VENV)/.run $(wildcard codegen/native/src/*) codegen/native/pyproject.toml codegen/native/setup.py
	@if [ "$$(uname -s)" = Linux ] && command -v cc >/dev/null; then \
		$(BIN)/python -m pip install --quiet --force-reinstall --no-deps ./codegen/native; \
	else echo "no C compiler: the tests of real rclpy with our own packages will be skipped"; fi
	@touch $@
