# Two commands for a fresh clone: `make demo` and `make test`. Both set up .venv first.
PYTHON ?= python3
BIN := .venv/bin
STAMP := .venv/.installed
LEARN := .venv/.installed-learn
DOCS := .venv/.installed-docs

# of `make fuzz`: about how long, and the seed of all inputs; of `make site-test`: how long the longest may take
MINUTES ?= 2
SEED ?= 1

# a test starts no helpers of its own
test fuzz kill-tests: export TAGALONG_COMPILERS = 1

.PHONY: demo test check bench docs site-test pictures dist fuzz kill-tests clean

demo: $(STAMP)
	$(BIN)/tagalong demo --out out/demo

test: $(LEARN)
	$(BIN)/python -m pytest -q -n 2 --dist worksteal

# every command that writes, killed twenty times: about an hour
kill-tests: $(LEARN)
	$(BIN)/python tests/kill_all.py
	$(BIN)/python tests/kill_all.py --hazards

check: $(LEARN)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/basedpyright --pythonpath $(BIN)/python

fuzz: $(LEARN)
	$(BIN)/python tests/fuzz/run.py --minutes $(MINUTES) --seed $(SEED) --out out/fuzz

bench: $(STAMP)
	$(BIN)/tagalong bench speed

# the site, in out/site; a warning, such as a broken link, is an error
docs: $(DOCS)
	$(BIN)/python -m tagalong.scripts.site out/site-source
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --strict --clean

# programs and commands of the site that take minutes, too
site-test: $(LEARN)
	TAGALONG_SITE_MINUTES=$(MINUTES) $(BIN)/python -m pytest -q tests/scripts/test_site.py

# the pictures of the site, drawn anew
pictures: $(STAMP)
	$(BIN)/python -m tagalong.scripts.site.pictures docs/images

# wheel and sdist in dist/, equal to the byte wherever the same commit is built
dist: $(STAMP)
	$(BIN)/python .ci/build_dist.py dist

$(STAMP): pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "tagalong needs Python 3.11 or newer; set PYTHON=...")'
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install -q --disable-pip-version-check -c constraints.txt -e ".[dev,viz]"
	@touch $@

# torch and what comes with it: for tests and types only, a demo needs none of it
$(LEARN): $(STAMP)
	$(BIN)/python -m pip install -q --disable-pip-version-check -c constraints.txt -e ".[dev,viz,learn]"
	@touch $@

$(DOCS): $(LEARN)
	$(BIN)/python -m pip install -q --disable-pip-version-check -c constraints.txt -e ".[dev,viz,learn,docs]"
	@touch $@

clean:
	rm -rf .venv out build *.egg-info
