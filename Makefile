# The front door. Each target installs what it needs (scripts/setup.sh) and then hands over to CMake.
JOBS := $(shell nproc 2>/dev/null || echo 2)
BRIO := build/brio
MAKEFLAGS += --no-print-directory

.PHONY: all demo check bench quality thesis clean

all:
	@sh scripts/setup.sh build
	cmake --preset release
	cmake --build build -j $(JOBS) --target brio-cli

demo: all
	@sh scripts/demo.sh $(BRIO) out

check:
	@sh scripts/setup.sh check
	@sh scripts/check.sh $(JOBS)

# BENCH="--runs 5 --only uniform_1m happy_raw" measures less, BENCH="--sizes 1e4 1e5 1e6 1e7" more: docs/benchmarks.md.
bench: all
	@sh scripts/setup.sh bench
	cmake -S . -B build-bench -DCMAKE_BUILD_TYPE=Release -DBRIO_TESTS=OFF -DBRIO_PEERS=ON
	cmake --build build-bench -j $(JOBS) --target peers
	@mkdir -p out
	/usr/bin/python3 bench/bench.py $(BRIO) build-bench out/bench.csv $(BENCH)
	/usr/bin/python3 bench/plot.py out/bench.csv out

# Judges the surfaces of every shared set: docs/quality.md, about half an hour. The same figures on every machine.
quality: all
	/usr/bin/python3 bench/quality.py $(BRIO) docs/quality.csv docs/quality.md

# The thesis' experiments at a fourth of their size; THESIS="--full --report docs/thesis-experiments.md" for all of it.
# Root, for the limits of memory: docs/benchmarks.md.
thesis: all
	@sh scripts/setup.sh thesis
	/usr/bin/python3 bench/thesis/thesis.py $(BRIO) $(THESIS)

clean:
	rm -rf build build-ci build-debug build-sanitize out
