# make demo   solve the paper's block, 100 x 100 elements, say where the results are, and compare three linear solvers
# make test   all tests
# make python the Python module, compiled and tested in an environment of its own; needs a network once
# make python-docs its notebooks, run, and compared with their pages in doc/python; PAGES=--write writes these
# make book   the site of doc/, in target/book; needs a network once
# make book-test the same in a headless Chromium, which it installs: links, search, formulas, pictures, phone width
# make readability reading ease and sentence length of the pages
# make archive the program with its licences, first page and manual, in target/archive
# make wheel  its wheel for any Linux since glibc 2.17, in target/wheels
# make sdist  its source package, in target/wheels; make sdist-test compiles and installs it in a fresh environment
# make wheel-test the same, installed and run in fresh environments of the Pythons at hand
# make pure   all tests of the program without any C library
# make campaign the tests that take minutes each (half an hour)
# make petsc  the program with PETSc, and its tests (installs PETSc and Open MPI)
# make bench  the benchmarks (minutes)
# make instructions the instructions of each kernel, counted by callgrind
# make everything all that the pages promise, with a table in doc/method/proved.md (hours)
# make lines  files, lines and types, by room and crate
# make tables the paper's Tables I and II, complete (minutes)
# make extremes the suite of extreme scenes, into doc/method/stability (minutes)
# make elements kinds of elements on Cook's membrane and Hertz' contacts, into doc/method/elements (minutes)
# make compare error against time for six scenes, into doc/method/error-vs-time.md (minutes)
# make fresh  demo and test from nothing, in a Debian 12 and a Debian 13 of their own (as root; an hour or more)
# make fuzz   an hour of random input: readers, and runs that are judged by laws of their own
# make sanitize the sanitizers over what calls C and what runs in several threads, and Miri where it is (an hour, compiling above all)
# make report the paper's Figures 4 to 7, into doc/method/figures, both tables, and the comparison (minutes)
# Each installs what is missing first.

PACKAGES = libsuitesparse-dev libopenblas-dev libclang-dev
SUDO := $(shell test "$$(id -u)" = 0 || echo sudo)

.PHONY: demo test pure campaign packages petsc python python-module python-docs wheel wheel-test sdist sdist-test book book-test readability archive bench instructions lines tables report extremes elements compare fresh everything fuzz sanitize deps

# Two more linear solvers work beside the run, on the second core; the last lines have their results and times beside each other.
demo: deps
	cargo build --release -p stickslip-cli
	@for solver in partial condensed; do \
		target/release/stickslip run data/scenes/block.toml --solver $$solver --threads 1 --quiet --out results/block-$$solver >/dev/null & done; \
	target/release/stickslip run data/scenes/block.toml --solver umfpack --threads 1 --out results/block && wait && \
	awk '/^  "solver":/ { gsub(/[",]/, ""); solver = $$2 } /^    "friction_work":/ { work = $$2 + 0 } \
		/^    "cpu_seconds":/ { printf "%-12s friction work %.11g J/m, %.2f s CPU\n", solver, work, $$2 }' \
		results/block/run.json results/block-partial/run.json results/block-condensed/run.json

# What the program does for itself: OpenBLAS falls back to its oldest kernel on processors that it does not know.
KERNEL := $(shell if grep -qw avx512vl /proc/cpuinfo; then echo SKYLAKEX; elif grep -qw avx2 /proc/cpuinfo; then echo HASWELL; fi 2>/dev/null)
BLAS = OPENBLAS_NUM_THREADS=1 $(if $(KERNEL),OPENBLAS_CORETYPE=$(KERNEL))

# The crates above the library; these with it; and all that stands on it, the studies and the fuzzing included.
UPPER = -p stickslip-output -p stickslip-exchange -p stickslip-cli
CRATES = -p stickslip $(UPPER)
ABOVE = $(UPPER) -p stickslip-studies -p stickslip-fuzz

# Unit tests take seconds however they are compiled. Tests run side by side, so that each has one thread.
test: deps
	cargo test -p stickslip --lib --config profile.test.package.stickslip.opt-level=0
	$(BLAS) cargo test $(ABOVE) --lib
	$(BLAS) cargo test --workspace --exclude stickslip-python --exclude stickslip-distributed --bins --example outside --test '*'
	cargo test $(CRATES) --doc

# The headers of SuiteSparse are hidden.
pure: export SUITESPARSE_INCLUDE_DIR = /nonexistent
pure:
	cargo test $(CRATES) --no-default-features --features faer

campaign: deps
	$(BLAS) cargo test --release --workspace --exclude stickslip-python --exclude stickslip-distributed --bins --test '*' -- --ignored

PETSC_PACKAGES = petsc-dev openmpi-bin libopenmpi-dev pkg-config

petsc: deps
	@dpkg -s $(PETSC_PACKAGES) >/dev/null 2>&1 || { $(SUDO) apt-get update -q && \
		$(SUDO) env DEBIAN_FRONTEND=noninteractive apt-get install -qy --no-install-recommends $(PETSC_PACKAGES); }
	cargo build --release -p stickslip-cli --features petsc
	$(BLAS) cargo test -p stickslip-distributed -p stickslip-cli --features stickslip-cli/petsc --lib --test large
	cargo clippy -p stickslip-distributed -p stickslip-cli --features stickslip-cli/petsc --all-targets --quiet -- -D warnings

# The packages of every build and every check, for `.ci/run`.
packages: deps
	@dpkg -s $(PETSC_PACKAGES) valgrind >/dev/null 2>&1 || { $(SUDO) apt-get update -q && \
		$(SUDO) env DEBIAN_FRONTEND=noninteractive apt-get install -qy --no-install-recommends $(PETSC_PACKAGES) valgrind; }

PYTHON = target/python/bin/python
PYTHON_WHEELS ?= python3.10 python3.11 python3.12 python3.13
# In the profile of what is compiled for the program without C libraries: all but the module itself is there then.
PYTHON_BUILD ?= --profile dev
# What the environment was made of; when python/requirements.txt changes, the environment is made again.
PYTHON_TOOLS = target/python/requirements.txt
# The system's libraries that the wheel of gmsh is linked to.
GMSH_PACKAGES = libgl1 libglu1-mesa libgomp1 libxcursor1 libxft2 libxinerama1
INSTALL = $(SUDO) apt-get update -q && $(SUDO) env DEBIAN_FRONTEND=noninteractive apt-get install -qy --no-install-recommends

# Needs a network once. No part of `make test`: its features of the library are others.
$(PYTHON_TOOLS): python/requirements.txt
	@python3 -c 'import ensurepip' 2>/dev/null || { $(INSTALL) python3-venv; }
	rm -rf target/python
	python3 -m venv target/python
	$(PYTHON) -m pip install -q --retries 1 -r python/requirements.txt
	@$(PYTHON) -c 'import gmsh' 2>/dev/null || { $(INSTALL) $(GMSH_PACKAGES) && $(PYTHON) -c 'import gmsh'; }
	cp python/requirements.txt $@

python-module: $(PYTHON_TOOLS)
	cd python && . ../target/python/bin/activate && maturin develop $(PYTHON_BUILD) --quiet

# A test that lacks a package fails here, and is skipped elsewhere.
python: python-module
	cd python && . ../target/python/bin/activate && mypy --no-error-summary && STICKSLIP_ALL_PACKAGES=1 python -m pytest -q -rs
	cargo test -p stickslip --quiet --no-default-features --features faer --test supply -- --ignored

PAGES ?=

# Two at a time, each with one thread.
python-docs: python-module
	$(PYTHON) python/docs/pages.py $(PAGES)

# WHEEL_TARGET = aarch64-unknown-linux-gnu, x86_64-unknown-linux-musl or aarch64-unknown-linux-musl makes one for other machines.
WHEEL_TARGET ?= $(shell uname -m)-unknown-linux-gnu
WHEEL_TAG = $(if $(findstring musl,$(WHEEL_TARGET)),musllinux_1_2,manylinux2014)
ZIG_TARGET = $(subst -unknown,,$(WHEEL_TARGET))$(if $(findstring musl,$(WHEEL_TARGET)),,.2.17)
REMAP = --remap-path-prefix=$(CURDIR)=stickslip --remap-path-prefix=$${CARGO_HOME:-$$HOME/.cargo}=cargo --remap-path-prefix=$$(rustc --print sysroot)=rust

wheel: $(PYTHON_TOOLS)
	$(PYTHON) -m pip install -q ziglang==0.17.1
	[ -d "$$(rustc --print sysroot)/lib/rustlib/$(WHEEL_TARGET)" ] || rustup target add $(WHEEL_TARGET)
	cd python && . ../target/python/bin/activate && ZIG_TARGET=$(ZIG_TARGET) RUSTFLAGS="$(REMAP)$(if $(findstring musl,$(WHEEL_TARGET)), -C target-feature=-crt-static)" \
		maturin build --release --target $(WHEEL_TARGET) --compatibility $(WHEEL_TAG) --out ../target/wheels -- -C linker=$(CURDIR)/python/zigcc

wheel-test: wheel
	python/wheel_test.sh target/wheels/stickslip-*-abi3-manylinux*$(firstword $(subst -, ,$(WHEEL_TARGET))).whl $(PYTHON_WHEELS)

sdist: $(PYTHON_TOOLS)
	cd python && . ../target/python/bin/activate && maturin sdist --out ../target/wheels

sdist-test: sdist
	python/sdist_test.sh target/wheels/stickslip-*.tar.gz python3

# What each environment was made of, as PYTHON_TOOLS above.
BOOK_TOOLS = target/book-tools/requirements.txt
BOOK_TEST_TOOLS = target/book-tools/requirements-test.txt
BOOK_PIP = target/book-tools/bin/python -m pip install -q --disable-pip-version-check --retries 1

$(BOOK_TOOLS): doc/requirements.txt
	@python3 -c 'import ensurepip' 2>/dev/null || { $(INSTALL) python3-venv; }
	rm -rf target/book-tools
	python3 -m venv target/book-tools
	$(BOOK_PIP) -r doc/requirements.txt
	cp doc/requirements.txt $@

$(BOOK_TEST_TOOLS): doc/site/requirements.txt $(BOOK_TOOLS)
	$(BOOK_PIP) -r doc/site/requirements.txt
	cp doc/site/requirements.txt $@

book: $(BOOK_TOOLS)
	@NO_MKDOCS_2_WARNING=1 target/book-tools/bin/mkdocs build --strict >target/book-tools/log 2>&1 || { cat target/book-tools/log; exit 1; }
	@echo "the site is in target/book/index.html"

# CHROMIUM names a browser that is installed elsewhere.
# The pages of runs are made by the program.
book-test: book deps $(BOOK_TEST_TOOLS)
	cargo build -p stickslip-cli --quiet
	@[ -n "$$CHROMIUM" ] || command -v chromium >/dev/null || { $(INSTALL) chromium; }
	target/book-tools/bin/python -m pytest -q -rs -p no:cacheprovider doc/site

readability: $(BOOK_TEST_TOOLS)
	target/book-tools/bin/python doc/site/readability.py

# The program as it is handed on: what links UMFPACK is under the GPL (README.md, Licence). ARCHIVE_BUILD = --no-default-features
# --features faer makes one without a C library.
ARCHIVE_BUILD ?=
ARCHIVE = stickslip-$(shell sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -1)-$(shell uname -m)-linux

archive: $(if $(ARCHIVE_BUILD),,deps)
	cargo build --release -p stickslip-cli $(ARCHIVE_BUILD)
	rm -rf target/archive/$(ARCHIVE)
	mkdir -p target/archive/$(ARCHIVE)/man
	cp target/release/stickslip README.md CHANGELOG.md CITATION.cff LICENSE-APACHE LICENSE-MIT target/archive/$(ARCHIVE)
	python/licences.sh stickslip-cli $(CURDIR)/target/archive/$(ARCHIVE) $(or $(ARCHIVE_BUILD),--features stickslip-cli/default)
	cd target/archive/$(ARCHIVE) && for page in "" $$(./stickslip --help | sed -n '/^Commands:/,/^$$/s/^  \([a-z]*\) .*/\1/p' | grep -v help); do \
		./stickslip man $$page >man/stickslip$${page:+-$$page}.1; done
	tar -C target/archive -czf target/archive/$(ARCHIVE).tar.gz $(ARCHIVE)
	@echo target/archive/$(ARCHIVE).tar.gz

bench: deps
	cargo bench -p stickslip-studies --bench factor
	cargo bench -p stickslip-studies --bench history
	cargo bench -p stickslip-studies --bench cholesky
	cargo bench -p stickslip-studies --bench condensed
	cargo bench -p stickslip-studies --bench scaling
	cargo bench -p stickslip-studies --bench scaling3d
	cargo bench -p stickslip-studies --bench crossover

KERNELS = assembly condensation jacobian residual dense-factor substitution bn-iteration

# callgrind takes a program, and cargo names it: the last executable that it builds is this one.
instructions: deps
	@command -v valgrind >/dev/null || $(SUDO) env DEBIAN_FRONTEND=noninteractive apt-get install -qy --no-install-recommends valgrind
	@program=$$(cargo bench -p stickslip-studies --bench instructions --no-run --message-format=json 2>/dev/null \
		| sed -n 's/.*"executable":"\([^"]*instructions-[^"]*\)".*/\1/p'); \
	for kernel in $(KERNELS); do \
		count=$$(valgrind --tool=callgrind --callgrind-out-file=/dev/null '--toggle-collect=*measured_kernel*' \
			"$$program" $$kernel 2>&1 | sed -n 's/.*Collected : //p'); \
		[ -n "$$count" ] || { echo "callgrind failed on $$kernel"; exit 1; }; \
		printf '%-14s %14s\n' "$$kernel" "$$count"; \
	done

lines:
	@.ci/lines

STUDIES = cargo run --release -p stickslip-studies --

tables: deps
	$(STUDIES) tables punch
	$(STUDIES) tables block

extremes: deps
	$(STUDIES) extremes --long --out doc/method/stability

elements: deps
	$(STUDIES) elements --out doc/method/elements

COMPARE = cargo run --release -- compare
PAGE = doc/method/error-vs-time
SOLID = --solvers umfpack,partial,condensed
PAPER = --methods bn,ip,events --settings default,paper $(SOLID)
ONE = --threads 1
PLATE = --set 'title="Elastic plate on a frictional foundation"' --set 'mesh.elements=[16,16,4]' --set 'mesh.size=[1,1,0.25]'

# The pictures of the page; all numbers are in compare.csv and meshes.csv.
compare: deps
	$(COMPARE) data/scenes/block.toml $(PAPER) --meshes 25,50,100 --increments 10,40 $(ONE) --out $(PAGE)/block
	$(COMPARE) data/scenes/punch.toml $(PAPER) --meshes 20,30,40 --increments 10,40,80 $(ONE) --out $(PAGE)/punch
	$(COMPARE) data/scenes/frictionless.toml $(PAPER) --meshes 25,50,100 --increments 2,10 $(ONE) --out $(PAGE)/frictionless
	$(COMPARE) data/scenes/strip.toml --methods bn,ip,events --meshes 75,150,300 --increments 15,60 $(ONE) --out $(PAGE)/strip
	$(COMPARE) data/scenes/cube.toml $(SOLID) --meshes 4,8,16 --increments 5,10,20 $(ONE) --out $(PAGE)/cube
	$(COMPARE) data/scenes/cube.toml $(PLATE) $(SOLID) --meshes 8,16 --increments 5,10 $(ONE) --out $(PAGE)/plate
	cd $(PAGE) && rm -f */compare.md */iterations.csv */mesh-size.svg

fresh:
	.ci/fresh

everything:
	.ci/everything

FUZZ = OPENBLAS_NUM_THREADS=1 RAYON_NUM_THREADS=1 cargo run -p stickslip-fuzz --
FUZZ_SECONDS = 1800
FUZZ_SEED := $(shell date +%s)000000
FUZZ_JOBS := $(shell nproc 2>/dev/null || echo 1)

# Other seeds each time; a failure is told with its own. Without --release numbers that overflow are found, too.
fuzz: deps
	$(FUZZ) readers --seconds $(FUZZ_SECONDS) --seed $(FUZZ_SEED) --jobs $(FUZZ_JOBS)
	$(FUZZ) runs --seconds $(FUZZ_SECONDS) --seed $(FUZZ_SEED) --jobs $(FUZZ_JOBS)

sanitize: deps
	.ci/sanitize

report: deps
	$(STUDIES) figures --out doc/method/figures
	$(MAKE) tables
	$(MAKE) compare

# SUITESPARSE_INCLUDE_DIR says that SuiteSparse is installed in a place of its own.
deps:
	@if [ -z "$$SUITESPARSE_INCLUDE_DIR" ] && ! dpkg -s $(PACKAGES) >/dev/null 2>&1; then \
		command -v apt-get >/dev/null || { echo "install SuiteSparse, OpenBLAS and libclang; see doc/howto/install.md"; exit 1; }; \
		$(SUDO) apt-get update -q && \
		$(SUDO) env DEBIAN_FRONTEND=noninteractive apt-get install -qy --no-install-recommends $(PACKAGES); \
	fi
