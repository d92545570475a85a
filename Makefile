# make demo   solve the paper's block, 100 x 100 elements, and say where the results are
# make test   all tests
# make bench  the benchmarks (minutes)
# make tables the paper's Tables I and II, complete (minutes)
# make extremes the suite of extreme scenes, into doc/stability (minutes)
# make report the paper's Figures 4 to 7, into doc/figures, and both tables (minutes)
# Each installs what is missing first.

PACKAGES = libsuitesparse-dev libopenblas-dev libclang-dev
SUDO := $(shell test "$$(id -u)" = 0 || echo sudo)

.PHONY: demo test bench tables report extremes deps

demo: deps
	cargo run --release -- run data/scenes/block.toml --out results/block

test: deps
	cargo test

bench: deps
	cargo bench --bench factor
	cargo bench --bench history
	cargo bench --bench interior
	cargo bench --bench cholesky
	cargo bench --bench condensed
	cargo bench --bench scaling
	cargo bench --bench crossover

tables: deps
	cargo run --release -- tables punch
	cargo run --release -- tables block

extremes: deps
	cargo run --release -- extremes --long --out doc/stability

report: deps
	cargo run --release -- figures --out doc/figures
	$(MAKE) tables

# SUITESPARSE_INCLUDE_DIR says that SuiteSparse is installed in a place of its own.
deps:
	@if [ -z "$$SUITESPARSE_INCLUDE_DIR" ] && ! dpkg -s $(PACKAGES) >/dev/null 2>&1; then \
		command -v apt-get >/dev/null || { echo "install SuiteSparse, OpenBLAS and libclang; see README.md"; exit 1; }; \
		$(SUDO) apt-get update -q && \
		$(SUDO) env DEBIAN_FRONTEND=noninteractive apt-get install -qy --no-install-recommends $(PACKAGES); \
	fi
