# SPDX-License-Identifier: MIT
#
# The short way in: `make demo` and `make test` on a fresh Debian 12 machine. Everything is built by CMake
# (CMakeLists.txt, CMakePresets.json); these words only call it.
#
#   make            installs what is missing, builds build/bin/cattaneo (double) and build/bin/cattaneof (single)
#   make demo       the same, then runs the main example and says where its pictures and data are (under out/)
#   make test       the same, then every test but the long ones
#   make test-long  every test, then those that are not long again under the sanitizers and valgrind: hours of a core
#   make gallery    makes every picture of the examples and the README (hours; may be stopped and called again)
#   make fuzz       readers under libFuzzer (clang), FUZZ_SECONDS each: 3600; other changes each time, or those of
#                   FUZZ_SEED
#   make sanitize   the tests with the address, undefined-behaviour and thread sanitizers, a few steps of every scene
#                   among them; what would be long there is named in CMakePresets.json
#   make valgrind   the tests of the floors under valgrind, but for those that would take minutes each
#   make format     puts the C files into the project's form (clang-format)
#   make lint       what can be said about the sources without running them
#   make clean      removes build/
#
# Another build folder: make BUILD=elsewhere test

BUILD ?= build
JOBS  ?= $(shell nproc 2>/dev/null || echo 2)
CTEST  = ctest --test-dir $(BUILD) --output-on-failure -j$(JOBS)

.PHONY: all demo gallery test test-long fuzz sanitize valgrind format lint clean setup setup-tests setup-checks configure programs

all: programs

# --- set-up and build -------------------------------------------------------------------------------------

setup:
	@tools/setup.sh build

setup-tests:
	@tools/setup.sh build test

setup-checks:
	@tools/setup.sh build test check

# Ninja where there is a choice; a folder that was configured before keeps what it has.
configure:
	@test -e $(BUILD)/build.ninja || test -e $(BUILD)/Makefile || cmake -S . -B $(BUILD) -G Ninja -DCATTANEO_WERROR=ON

programs: setup
	@$(MAKE) --no-print-directory configure
	@cmake --build $(BUILD) --parallel $(JOBS) --target product

# --- words that run something -----------------------------------------------------------------------------

demo: setup
	@$(MAKE) --no-print-directory configure
	@cmake --build $(BUILD) --parallel $(JOBS) --target cattaneo_program_double
	@CATTANEO=$(abspath $(BUILD))/bin/cattaneo examples/cone/demo.sh out/cone

gallery: programs
	@tools/setup.sh gallery
	@CATTANEO=$(abspath $(BUILD))/bin/cattaneo tools/gallery.sh $(abspath out)/gallery

test: setup-tests
	@$(MAKE) --no-print-directory configure
	@cmake --build $(BUILD) --parallel $(JOBS)
	@$(CTEST) --label-exclude long

test-long: setup-tests
	@$(MAKE) --no-print-directory configure
	@cmake --build $(BUILD) --parallel $(JOBS)
	@$(CTEST)
	@$(MAKE) --no-print-directory sanitize valgrind

FUZZ_SECONDS ?= 3600
FUZZ_SEED ?= 0

fuzz: setup-checks
	@cmake --preset fuzz -DCATTANEO_FUZZ_SECONDS=$(FUZZ_SECONDS) -DCATTANEO_FUZZ_SEED=$(FUZZ_SEED)
	@cmake --build --preset fuzz --parallel $(JOBS)
	@ctest --preset fuzz -j$(JOBS)

sanitize: setup-checks
	@for preset in asan-ubsan tsan; do \
	  cmake --preset $$preset && cmake --build --preset $$preset --parallel $(JOBS) && \
	  ctest --preset $$preset -j$(JOBS) --label-exclude long || exit 1; \
	done

VALGRIND = valgrind -q --error-exitcode=9 --leak-check=full --errors-for-leak-kinds=definite \
  --show-leak-kinds=definite --suppressions=$(CURDIR)/tests/memory/known.supp

# They would work for more than five minutes each, thirty times what they take alone; the sanitizers have them.
VALGRIND_LONG = unit_(session_session|solve_(iterations|region)|app_sweep|model_gel|render_studio|physics_advect_(schemes|accuracy))

valgrind: setup-checks
	@$(MAKE) --no-print-directory configure
	@cmake --build $(BUILD) --parallel $(JOBS)
	@mkdir -p $(BUILD)/valgrind
	@cd $(BUILD) && ls tests | grep -E '^(unit|memory)_' | grep -vE '_single|^$(VALGRIND_LONG)$$' | \
	  OMP_NUM_THREADS=2 OMP_WAIT_POLICY=passive xargs -P$(JOBS) -I{} sh -c \
	  '$(VALGRIND) tests/{} >valgrind/{} 2>&1 && echo "{}: clean" || { cat valgrind/{}; exit 255; }'

# --- sources ----------------------------------------------------------------------------------------------

SOURCES = $(wildcard src/*/*.[ch] include/*.h tests/*/*.[ch] tests/*/*/*.[ch] examples/c/*.c)

format:
	@clang-format -i $(SOURCES)

lint:
	@tools/floors.py
	@clang-format --dry-run -Werror $(SOURCES)
	@echo "lint: nothing to say"

clean:
	@rm -rf $(BUILD)
