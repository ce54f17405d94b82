.DEFAULT_GOAL := help
BIN ?= .venv/bin

.PHONY: help check test test-oldest docs bench

help:  ## what there is
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed 's/:.*## /\t/'

check:  ## lint, types, architecture contract
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

test:  ## all tests
	$(BIN)/pytest -q -n 2 --dist worksteal

test-oldest:  ## all tests at the oldest versions allowed, in an environment of their own
	python3 -m venv .venv-oldest
	.venv-oldest/bin/pip install --quiet --constraint constraints-floor.txt ".[test]"
	.venv-oldest/bin/pytest -q -n 2 --dist worksteal

docs:  ## the documentation in build/site, everything in it run; open build/site/index.html
	@test -x $(BIN)/python || python3 -m venv $(BIN)/..
	@$(BIN)/python -c "import myst_nb, sphinx_gallery, elbowscrew" 2> /dev/null || $(BIN)/pip install --quiet -e ".[docs]"
	$(BIN)/python docs/make_settings.py
	$(BIN)/python docs/make_schemas.py
	$(BIN)/python docs/make_man.py
	$(BIN)/sphinx-build -W --keep-going --quiet docs build/site

bench:  ## every stage beside what one would use instead
	$(BIN)/pip install --quiet -e ".[bench]"
	$(BIN)/python benchmarks/performance.py
