# Which Rust builds for a device: to be sourced, not run. Afterwards
#
#   use_device_rust TARGET    chooses rustup's target where there is one, else Debian's Rust with a `core` of its own making,
#   device_cargo ARGS...      is cargo for that target (build, rustc, ...), in a folder of the target's own.
#
# LEAFBRDF_DEVICE_RUST=rustup|debian forces one. Nothing but stable features is used: RUSTC_BOOTSTRAP is unset.
# `host` as target is this machine, by the Rust that builds everything else.

device_work=${CARGO_TARGET_DIR:-$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)/target}
mkdir -p "$device_work"

rustup_has() {
    command -v rustup >/dev/null || return 1
    rustup target list --installed 2>/dev/null | grep -qx "$1" ||
        timeout 300 rustup target add "$1" >"$device_work/rustup.log" 2>&1
}

# Debian's rustc comes without `core` for the device. Built once from its own sources, that library is put where rustc
# looks for it; from then on everything is a plain stable build.
debian_core_for() {
    local target=$1 version library=$device_work/sysroot/lib/rustlib/$1/lib stamp core=$device_work/debian-core
    version=$(/usr/bin/rustc --version)
    stamp=$device_work/sysroot/$target.version
    [[ -f $stamp && $(<"$stamp") == "$version" ]] && return
    rm -rf "$library" "$device_work/debian" # what was built against another core is of no use
    mkdir -p "$library" "$core/src"
    printf '[package]\nname = "core-only"\nversion = "0.0.0"\nedition = "2024"\n[workspace]\n' >"$core/Cargo.toml"
    echo '#![no_std]' >"$core/src/lib.rs"
    (
        cd "$core"
        # with bitcode, for the profile that optimises at link time
        RUSTC=/usr/bin/rustc RUSTC_BOOTSTRAP=1 RUSTFLAGS='-Cembed-bitcode=yes' CARGO_TARGET_DIR=$core/target \
            cargo build -Z build-std=core --target "$target" --release
    )
    cp "$core/target/$target"/release/deps/lib{core,compiler_builtins}-*.rlib "$library"
    echo "$version" >"$stamp"
}

use_device_rust() {
    device_target=$1
    unset RUSTC_BOOTSTRAP # it would let an unstable feature through unseen
    if [[ $device_target == host ]]; then
        device_target=$(rustc -vV | sed -n 's/^host: //p')
        device_cargo() { local verb=$1; shift; cargo "$verb" --locked --target "$device_target" "$@"; }
        device_cargo_name=host
        return
    fi
    device_cargo_name=${LEAFBRDF_DEVICE_RUST:-}
    if [[ -z $device_cargo_name ]]; then
        if rustup_has "$device_target"; then device_cargo_name=rustup; else device_cargo_name=debian; fi
    fi
    case $device_cargo_name in
    rustup)
        rustup_has "$device_target" ||
            { echo "rustup has no $device_target: see $device_work/rustup.log" >&2; return 1; }
        device_cargo() { local verb=$1; shift; cargo "$verb" --locked --target "$device_target" "$@"; }
        ;;
    debian)
        debian_core_for "$device_target"
        device_cargo() {
            local verb=$1
            shift
            RUSTC=/usr/bin/rustc RUSTFLAGS="--sysroot $device_work/sysroot -Clinker=ld.lld" \
                CARGO_TARGET_DIR=$device_work/debian cargo "$verb" --locked --target "$device_target" "$@"
        }
        ;;
    *)
        echo "LEAFBRDF_DEVICE_RUST is '$device_cargo_name': expected rustup or debian" >&2
        return 2
        ;;
    esac
}

# The version of the compiler that use_device_rust has chosen: costs are comparable within one version only.
device_rustc_version() {
    local rustc=rustc
    [[ $device_cargo_name == debian ]] && rustc=/usr/bin/rustc
    "$rustc" --version | cut -d ' ' -f 2
}

# What must not be in an image or object: the panic machinery, and the allocator's and C's heap.
forbidden_symbols='panic|unwrap_failed|expect_failed|__rust_alloc|__rust_dealloc|__rust_realloc|__rg_|handle_alloc_error|malloc|_sbrk'

# The long name of a target that people call by a short one.
target_named() {
    case $1 in
    m0 | m0+ | thumbv6m*) echo thumbv6m-none-eabi ;;
    m4 | m4f | thumbv7em*) echo thumbv7em-none-eabihf ;;
    m33 | thumbv8m*) echo thumbv8m.main-none-eabihf ;;
    rv32 | riscv32*) echo riscv32imc-unknown-none-elf ;;
    host) echo host ;;
    *)
        echo "unknown target '$1': expected m0, m4f, m33, rv32 or host" >&2
        return 2
        ;;
    esac
}

# The prefix of the GNU tools for a target.
binutils_of() {
    case $1 in
    thumb*) echo arm-none-eabi- ;;
    riscv32*) echo riscv64-unknown-elf- ;;
    *) echo ;;
    esac
}
