# SPDX-License-Identifier: BSD-3-Clause
# A thin front for the presets. `make demo` and `make test` work from a clean clone on Debian or Ubuntu.
SHELL := /bin/bash
JOBS ?= $(shell nproc)
CMAKE_ARGS ?=
# Many sources are compiled as one (agrisee_units in CMakeLists.txt): a clean build takes less than half the time. To change the
# code, use the presets, which compile one by one.
FEW_LARGE_UNITS := -DCMAKE_UNITY_BUILD=ON -DAGRISEE_PRECOMPILE=OFF
CONFIGURE := cmake -S . -B build/release -G Ninja -DCMAKE_BUILD_TYPE=Release $(FEW_LARGE_UNITS) $(CMAKE_ARGS)
AGRISEE := build/release/agrisee

.PHONY: help build demo test packages python experiment bench fuzz survive long mutate format format-check clean
SECONDS_IN_ALL ?= 14400
KILLS ?= 100
RUNS ?= 1000
MUTANTS ?= 60

help:
	@echo "make demo    install what is missing, build, scan a 7-fruit truss, evaluate it, draw it"
	@echo "make test    install what is missing, build and run all tests"
	@echo "make python  install what is missing, build the Python module, run its tests"
	@echo "make packages  Debian packages of command, library and Python module, a source tarball and checksums: build/packages"
	@echo "make experiment  rerun what is missing of the paper's experiment, and write docs/experiment.md, docs/planners.md"
	@echo "make bench   build and run the benchmarks, against other libraries where they are installed; docs/benchmarks.md"
	@echo "make fuzz    fuzz the readers with clang's libFuzzer, for hours (SECONDS_IN_ALL=60: for a minute)"
	@echo "make survive kill a scan a hundred times (KILLS=...) and fill its disk: nothing may be lost"
	@echo "make long    scan a thousand trusses in one process (RUNS=...): memory and time may not grow"
	@echo "make mutate  change the code at random and list what no test notices (MUTANTS=... a folder)"
	@echo "make format  run clang-format on all sources; make format-check: only say what it would change"
	@echo "make clean   remove build/ and demo/"

build:
	@cmake/packages.sh build
	@[ -x $(AGRISEE) ] || echo "Building agrisee on $(JOBS) cores: some five minutes of processor time, the first time only"
	@$(CONFIGURE) -DAGRISEE_BUILD_TESTS=OFF -DAGRISEE_BUILD_EXAMPLES=OFF
	@cmake --build build/release -j $(JOBS)

demo: build
	@$(AGRISEE) make-truss --total 7 --hidden 1 --seed 1 -o demo/scene --force
	@$(AGRISEE) scan demo/scene/scene.yaml -o demo/result --noise l515 --seed 1 --force
	@$(AGRISEE) evaluate demo/scene/scene.yaml demo/result
	@echo "Picture: demo/result/truss.png, report for a browser: demo/result/report.html"

test:
	@cmake/packages.sh build test
	@$(CONFIGURE) -DAGRISEE_BUILD_TESTS=ON -DAGRISEE_BUILD_EXAMPLES=ON
	@cmake --build build/release -j $(JOBS)
	@cd build/release && ctest --output-on-failure -j $(JOBS)

python:
	@cmake/packages.sh build test python
	@$(CONFIGURE) -DAGRISEE_BUILD_PYTHON=ON -DAGRISEE_BUILD_TESTS=ON
	@cmake --build build/release --target agrisee_python -j $(JOBS)
	@cd build/release && ctest -R '^python\.' --output-on-failure
	@echo "To use it with $$(sed -n 's/^AGRISEE_MODULE_PYTHON:INTERNAL=//p' build/release/CMakeCache.txt):" \
	  "export PYTHONPATH=$$PWD/build/release/python"

# The source tarball holds what is committed; SOURCE_DATE_EPOCH makes the packages the same bytes each time.
packages:
	@cmake/packages.sh build python
	@$(CONFIGURE) -DAGRISEE_BUILD_PYTHON=ON -DAGRISEE_BUILD_TESTS=OFF -DAGRISEE_BUILD_EXAMPLES=OFF
	@cmake --build build/release -j $(JOBS)
	@rm -rf build/packages && mkdir -p build/packages
	@export SOURCE_DATE_EPOCH=$$(git log -1 --format=%ct) && cd build/release && cpack -G DEB -B ../packages >/dev/null
	@rm -rf build/packages/_CPack_Packages
	@v=$$(ls build/packages/libagrisee-dev_*.deb | cut -d_ -f2) && \
	  git archive --format=tar --prefix=agrisee-$$v/ HEAD | gzip -n >build/packages/agrisee-$$v.tar.gz
	@cd build/packages && sha256sum *.deb *.tar.gz >SHA256SUMS && cat SHA256SUMS

experiment: build
	@$(AGRISEE) experiment -o build/experiment --report docs/experiment.md --presets paper,default \
	  --noise none,l515,gaussian:0.01,rough --trials 3 --paper-trials 1
	@$(AGRISEE) experiment -o build/planners --report docs/planners.md --trials 3 --scanned-only \
	  --groups default/gain/l515,default/fixed/l515,default/random/l515,default/greedy/l515,see/see/l515,paper/see/l515 \
	  --groups default/gain/gaussian:0.002,see/see/gaussian:0.002,paper/see/gaussian:0.002 \
	  --groups default/gain/none/free,see/see/none/free,paper/see/none/free

bench:
	@cmake/packages.sh build bench
	@cmake -S . -B build/bench -G Ninja -DCMAKE_BUILD_TYPE=Release -DAGRISEE_BUILD_BENCHMARKS=ON -DAGRISEE_BENCHMARK_PEERS=ON \
	  -DAGRISEE_BUILD_TESTS=OFF -DAGRISEE_BUILD_EXAMPLES=OFF -DAGRISEE_BUILD_CLI=OFF
	@cmake --build build/bench -j $(JOBS)
	@python3 benchmarks/report.py build/bench docs/benchmarks.md $(if $(LARGE),--large)

fuzz:
	@cmake/packages.sh build fuzz
	@cmake --preset fuzz -G Ninja $(FEW_LARGE_UNITS)
	@cmake --build --preset fuzz -j $(JOBS)
	@bash tests/fuzz/run.sh build/fuzz/fuzz $(SECONDS_IN_ALL)

survive: build
	@python3 tests/cli/survive.py $(AGRISEE) build/survive kill $(KILLS)
	@python3 tests/cli/survive.py $(AGRISEE) build/survive full || [ $$? = 77 ]

long:
	@cmake/packages.sh build test
	@$(CONFIGURE) -DAGRISEE_BUILD_TESTS=ON
	@cmake --build build/release --target long_run -j $(JOBS)
	@build/release/tests/long_run $(RUNS)

# Other versions of clang-format lay code out differently; CLANG_FORMAT=... names another program of the same version.
CLANG_FORMAT ?= $(firstword $(shell command -v clang-format-14 clang-format))
format:
	@$(CLANG_FORMAT) --version | grep -q ' 14\.' || { echo "make format: needs clang-format 14 (Debian 12's)"; exit 1; }
	@git ls-files '*.hpp' '*.cpp' | xargs $(CLANG_FORMAT) -i

format-check:
	@$(CLANG_FORMAT) --version | grep -q ' 14\.' || { echo "make format-check: needs clang-format 14 (Debian 12's)"; exit 1; }
	@git ls-files '*.hpp' '*.cpp' | xargs $(CLANG_FORMAT) --dry-run -Werror

mutate:
	@cmake/packages.sh build test
	@python3 tests/mutate.py --count $(MUTANTS) $(foreach room,plan fuse pick cloud,src/$(room) include/agrisee/$(room))

clean:
	@rm -rf build demo
