# What CI runs (.ci/run), piece by piece: each recipe and each step of CI is the same script.

# all of it
ci:
    .ci/run

# what the checks need and this machine lacks
setup:
    .ci/setup

# format, lints, duplicate dependencies
check:
    .ci/check

# all tests with default features
test *ARGS:
    .ci/test {{ARGS}}

# every feature set of every crate
features:
    .ci/features

# device build: no panic, no heap, the host's bits under QEMU
no-std:
    .ci/no-std

# costs on four boards under QEMU against firmware/footprint/footprint.csv; `just footprint update` rewrites it
footprint MODE="check":
    firmware/footprint/run {{MODE}}

# the C interface, its object and examples on simulated boards
firmware:
    .ci/firmware

# golden values only
golden:
    .ci/test --test golden

# documentation, warnings denied
docs:
    .ci/docs

# every crate packs and builds from its package
package:
    .ci/package

# SECONDS a target (all of them by default)
fuzz SECONDS="10" *TARGETS:
    .ci/fuzz {{SECONDS}} {{TARGETS}}

# timings; `just bench --test` only runs each once, as CI does
bench *ARGS:
    .ci/bench {{ARGS}}
