# Poligon on a fresh machine. `make help` says what there is.
#
#   ARGS="..."        more flags for the program, as in: make fly ARGS="--quality software"
#   SUBJECT=frame     what `make bench` measures: ground, frame, scene, plants, bake, mesh, flight, all
#   SKIP_PACKAGES=1   install no system packages (they are there, or come from elsewhere)

CARGO   ?= cargo
POLIGON := target/release/poligon
SHOTS   := target/pictures
SUBJECT ?= all
ARGS    ?=

# What winit and wgpu open at run time, and what gilrs links to. The Vulkan driver is Mesa's, which also draws without a graphics card.
RUN_PACKAGES  := mesa-vulkan-drivers libvulkan1 libudev-dev pkg-config libxkbcommon0 libxkbcommon-x11-0 \
                 libx11-6 libx11-xcb1 libxcursor1 libxi6 libxrandr2
TEST_PACKAGES := xvfb xauth xdotool umockdev

.DEFAULT_GOAL := help
# The steps of one goal build on each other.
.NOTPARALLEL:
.PHONY: help fly test lint bench pictures gallery release setup setup-test rust

help: ## this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-10s %s\n", $$1, $$2 }' Makefile

fly: release ## build it and fly: in a window where there is a display, else headless with pictures in target/pictures
	$(POLIGON) fly --shots $(SHOTS) $(ARGS)

test: setup-test lint ## formatting, lints, all tests
	$(CARGO) test --workspace --locked --no-fail-fast
	$(CARGO) test --package poligon-terrain --lib --locked --no-fail-fast --features cells32

lint: setup
	@.ci/component fmt rustfmt && $(CARGO) fmt --all --check || test $$? -eq 3
	@.ci/component clippy clippy && $(CARGO) clippy --workspace --all-targets --locked -- -D warnings || test $$? -eq 3

bench: release ## measure speed beside yardsticks
	$(POLIGON) bench $(SUBJECT) $(ARGS)

pictures: release ## take the pictures of the README anew
	$(POLIGON) fly --headless --lockstep --quality fine --size 960x540 --frames 60 --shots docs/pictures $(ARGS)

gallery: release ## take the gallery of the embedded world into target/gallery
	$(POLIGON) gallery --out target/gallery $(ARGS)

release: setup
	$(CARGO) build --release --locked

setup: rust
	@.ci/packages $(RUN_PACKAGES)

setup-test: rust
	@.ci/packages $(RUN_PACKAGES) $(TEST_PACKAGES)

rust:
	@.ci/rust
