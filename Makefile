# The front door. Each target installs what it needs (scripts/setup.sh) and then hands over to CMake.
JOBS := $(shell nproc 2>/dev/null || echo 2)
BRIO := build/brio
MAKEFLAGS += --no-print-directory

.PHONY: all demo check clean

all:
	@sh scripts/setup.sh build
	cmake --preset release
	cmake --build build -j $(JOBS) --target brio-cli

demo: all
	@sh scripts/demo.sh $(BRIO) out

check:
	@sh scripts/setup.sh check
	@sh scripts/check.sh $(JOBS)

clean:
	rm -rf build build-ci build-debug build-sanitize out
