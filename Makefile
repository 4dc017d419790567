# The front door, which hands over to CMake. `make` and `make all` install nothing: what is missing, they name, and `make setup`
# installs it, as root on Debian (scripts/setup.sh). Every other target installs what it needs first.
JOBS := $(shell nproc 2>/dev/null || echo 2)
BRIO := build/brio
MAKEFLAGS += --no-print-directory

.PHONY: all demo check check-all fuzz faults python python-heavy python-sanitize bench quality votes thesis machines deb site clean crosscheck bruteforce mutations metamorphic python-fuzz coverage setup model threads soak operations analyze targets wheels try-wheels recipes integrations release npm page mpi

all:
	@sh scripts/setup.sh build
	cmake --preset release
	cmake --build build -j $(JOBS) --target brio-cli

setup:
	@BRIO_SETUP=1 sh scripts/setup.sh build

# Also for `all`, which these build first.
demo bench quality votes thesis site integrations try-wheels: export BRIO_SETUP := 1

demo: all
	@sh scripts/demo.sh $(BRIO) out

check:
	@sh scripts/setup.sh check
	@sh scripts/check.sh $(JOBS)

# The same with all inputs, the packages, and the parallel tests with threads that give way at random: before a release.
check-all:
	@sh scripts/setup.sh check
	@sh scripts/check.sh $(JOBS) all

# Each fuzzer for some minutes of processor time: docs/measured/reliability.md. FUZZ="--subjects read write" runs some of them.
MINUTES := 1
fuzz:
	@sh scripts/setup.sh fuzz
	cmake --preset fuzz
	cmake --build build-fuzz -j $(JOBS)
	/usr/bin/python3 tests/fuzz/run.py build-fuzz --minutes $(MINUTES) --jobs $(JOBS) $(FUZZ)

# Faults at every point of runs: docs/measured/reliability.md. Small blocks are mappings here, so that small inputs have scratch files.
# FAULTS="--groups formats --kinds 'read fails'" runs some of them.
faults:
	@sh scripts/setup.sh check
	cmake --preset faults
	cmake --build build-faults -j $(JOBS) --target brio-cli fault fault_library fault_truncated
	/usr/bin/python3 tests/faults/faults.py build-faults/brio build-faults/tests/faults/libfault.so --jobs $(JOBS) $(FAULTS)
	build-faults/fault_library
	build-faults/fault_truncated tests/fuzz/corpus/read
	/usr/bin/python3 tests/faults/memory_limit.py build-faults/brio || [ $$? = 77 ]

# Results against CGAL, Qhull, voro++ and GUDHI: docs/measured/reliability.md. CROSSCHECK="--sets 200 --points 10000" compares less.
crosscheck:
	@sh scripts/setup.sh crosscheck
	cmake -S . -B build-crosscheck -DCMAKE_BUILD_TYPE=Release -DBRIO_TESTS=OFF -DBRIO_CROSSCHECK=ON
	cmake --build build-crosscheck -j $(JOBS) --target crosscheck brio-cli
	/usr/bin/python3 tests/oracles/crosscheck.py build-crosscheck $(CROSSCHECK)

# Results against brute force in exact integers, spoiled results against the checks, changed points against the same points:
# docs/measured/reliability.md. INPUTS says how many.
bruteforce mutations: INPUTS := 1000000
metamorphic: INPUTS := 10000
bruteforce mutations metamorphic:
	@sh scripts/setup.sh oracles
	cmake --preset release
	cmake --build build -j $(JOBS) --target $@
	build/$@ --inputs $(INPUTS)

# The same triangulation on many hosts, and its tests: docs/mpi.md.
mpi:
	@sh scripts/setup.sh mpi
	cmake -S . -B build-mpi -DCMAKE_BUILD_TYPE=Release -DBRIO_TESTS=OFF -DBRIO_MPI=ON
	cmake --build build-mpi -j $(JOBS) --target brio-cli brio-mpi
	/usr/bin/python3 tests/mpi/test_mpi.py build-mpi
	/usr/bin/python3 tests/mpi/test_mpi_faults.py build-mpi

# Lines and branches of src and cli that the tests and the fuzzers' inputs reach: a table, and pages in out/coverage.
# COVERAGE="-R unit" runs some of the tests: docs/measured/reliability.md.
coverage:
	@sh scripts/setup.sh coverage
	@sh scripts/coverage.sh $(JOBS) $(COVERAGE)

# The locks, by the model checker spin: docs/measured/reliability.md.
model:
	@sh scripts/setup.sh model
	@sh tests/model/run.sh || [ $$? = 77 ]

# Calls of the library for MINUTES in one process, whose memory and open files must not grow.
soak:
	@BRIO_SETUP=1 sh scripts/setup.sh build
	cmake --preset release
	cmake --build build -j $(JOBS) --target soak
	build/soak $(MINUTES)

# A million random operations on living triangulations, compared with building anew.
operations:
	@BRIO_SETUP=1 sh scripts/setup.sh build
	cmake --preset release
	cmake --build build -j $(JOBS) --target operations
	build/operations 1000000

# Every command in 2, 3 and 8 threads under the thread sanitizer, on larger inputs than make check has.
threads:
	@sh scripts/setup.sh threads
	cmake --preset stress
	cmake --build build-stress -j $(JOBS)
	ctest --test-dir build-stress --output-on-failure -E threads.commands
	BRIO=build-stress/brio python3 tests/threads/commands.py --long

# clang-tidy, cppcheck and gcc's analyzer; ANALYZE="src/io/*.c" looks at some files.
analyze:
	@sh scripts/setup.sh analyze
	@sh scripts/analyze.sh $(JOBS) $(ANALYZE)

# The npm package, out/npm/brio-VERSION.tgz, tried in a fresh folder: docs/javascript.md.
npm: all
	@sh scripts/setup.sh npm
	@BRIO=$(CURDIR)/$(BRIO) sh scripts/npm.sh test $(JOBS)

# The page that takes a file and makes a surface of it, out/brio.html, tried in Chromium where there is one: docs/view.md.
page: all
	@sh scripts/setup.sh npm
	@sh scripts/setup.sh web
	@sh scripts/npm.sh page $(JOBS)
	@node tests/browser/drop_test.mjs $(CURDIR)/$(BRIO) $(CURDIR)/out/brio.html long || [ $$? = 77 ]

# The Python package: a wheel and an sdist in out/python, tried in a new environment.
python:
	@sh scripts/setup.sh check
	@sh scripts/python.sh wheel

# The wheel beside torch, Open3D and scikit-learn, in one process: 1 GB of packages from Debian and PyPI.
python-heavy: python
	@sh scripts/python.sh heavy

# The Python package's tests under the address and undefined-behaviour sanitizers.
python-sanitize:
	@sh scripts/setup.sh check
	@JOBS=$(JOBS) sh scripts/python.sh sanitized

# Random calls of the Python package for so many minutes, under the same sanitizers.
python-fuzz:
	@sh scripts/setup.sh check
	@JOBS=$(JOBS) MINUTES=$(MINUTES) sh scripts/python.sh fuzz

# BENCH="--runs 5 --only uniform_1m happy_raw" measures less, BENCH="--sizes 1e4 1e5 1e6 1e7" more: docs/measured/benchmarks.md.
bench: all
	@sh scripts/setup.sh bench
	cmake -S . -B build-bench -DCMAKE_BUILD_TYPE=Release -DBRIO_TESTS=OFF -DBRIO_PEERS=ON
	cmake --build build-bench -j $(JOBS) --target peers
	@mkdir -p out
	/usr/bin/python3 bench/bench.py $(BRIO) build-bench out/bench.csv $(BENCH)
	/usr/bin/python3 bench/plot.py out/bench.csv out

# Judges surfaces of models of known topology, of generated solids, and of every shared set: docs/measured/quality.md.
# QUALITY="--parts corpus --samplings even" measures less: docs/measured/benchmarks.md. RIVALS=1 installs Open3D and CGAL and
# gives them the open scans, too.
quality: all
	@sh scripts/setup.sh quality
	@[ -z "$(RIVALS)" ] || sh scripts/setup.sh rivals
	@[ -z "$(RIVALS)" ] || cmake -S . -B build-bench -DCMAKE_BUILD_TYPE=Release -DBRIO_TESTS=OFF -DBRIO_PEERS=ON
	@[ -z "$(RIVALS)" ] || cmake --build build-bench -j $(JOBS) --target cgal_advancing_front || true
	/usr/bin/python3 bench/quality/quality.py $(BRIO) docs/measured $(if $(RIVALS),--rivals) $(QUALITY)

# The tables of src/reconstruct/labeled_delaunay/vote_weight.c, from generated solids with odd seeds: out/votes.txt.
votes: all
	@sh scripts/setup.sh quality
	/usr/bin/python3 bench/quality/make_corpus.py out/solids-choose --seeds 1-120 --half choose --brio $(BRIO)
	/usr/bin/python3 bench/quality/measure_votes.py out/solids-choose --brio $(BRIO) --counts out/votes.npz >out/votes.txt

# The thesis' experiments at a fourth of their size; THESIS="--full --report docs/measured/thesis-experiments.md" for all of it.
# Root, for the limits of memory: docs/measured/benchmarks.md.
thesis: all
	@sh scripts/setup.sh thesis
	@cmake -S . -B build-bench -DCMAKE_BUILD_TYPE=Release -DBRIO_TESTS=OFF -DBRIO_PEERS=ON
	@cmake --build build-bench -j $(JOBS) --target cgal_hierarchy || echo "thesis: without CGAL" >&2
	/usr/bin/python3 bench/thesis/thesis.py $(BRIO) $(THESIS)

# Other processors, systems and compilers give the same bits: docs/measured/machines.md.
machines:
	@sh scripts/setup.sh machines
	/usr/bin/python3 tests/machines/machines.py . out/machines

# Every system that brio is for, built here, and run where this machine can: docs/platforms.md. TARGETS="--only wasm32-wasi" for some.
targets:
	@sh scripts/setup.sh targets
	/usr/bin/python3 tests/targets/targets.py . build/targets $(TARGETS)

# The documentation as a site, out/site: scripts/site.sh. PICTURES=1 draws docs/images/gallery anew.
site: all
	@sh scripts/setup.sh site
	@sh scripts/site.sh build

# The Python package for every system, and an sdist, in build/wheels: docs/python/building.md. WHEELS="--only windows-x86_64" for some.
wheels:
	@sh scripts/setup.sh check
	@sh scripts/setup.sh packages
	@sh scripts/setup.sh targets
	/usr/bin/python3 scripts/wheels.py . build/wheels out/tests-env/bin/python $(WHEELS)

# The wheels of these systems, installed where they belong, with the package's tests: docs/python/building.md. WHEELS as above.
try-wheels: all
	@sh scripts/setup.sh check
	@sh scripts/setup.sh targets
	@sh scripts/setup.sh pythons
	/usr/bin/python3 tests/targets/wheels.py . build/wheels build/wheels-tried --native $(BRIO) $(WHEELS)

# The recipes for conda, vcpkg and Homebrew, as far as their tools can be had: docs/release.md.
recipes:
	@sh scripts/setup.sh recipes
	/usr/bin/python3 packaging/check/check.py . out/recipes

# PyVista, meshio and trimesh, Blender, QGIS: each as integrations/README.md says. BLENDER=1 installs Blender's Python package, 1.4 GB.
integrations: all
	@sh scripts/setup.sh check
	@sh scripts/setup.sh packages
	@[ -z "$(BLENDER)" ] || sh scripts/setup.sh blender
	cmake -S . -B build -DBRIO_TESTS=ON && cmake --build build -j $(JOBS) --target brio-python
	BRIO=$(CURDIR)/$(BRIO) BRIO_PYTHON=$(CURDIR)/build/python out/tests-env/bin/python integrations/run_tests.py

# Every archive of a release with its checksum, in build/release. It signs nothing and uploads nothing: docs/release.md.
release: wheels npm page deb
	@sh scripts/release.sh

# Debian packages of what is committed, in out/deb.
deb:
	@sh scripts/setup.sh deb
	@sh scripts/deb.sh

clean:
	rm -rf build build-ci build-debug build-faults build-fuzz build-sanitize out build-crosscheck build-coverage build-analyze build-stress build-threads
