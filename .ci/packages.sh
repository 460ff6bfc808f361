# shellcheck shell=bash
# Sourced by c_examples/run.sh and tests/run.sh: installs the Debian packages that are lacking, and says which.

# Packages that building the examples needs.
# shellcheck disable=SC2034
example_packages=(cmake g++ gcc gnuplot-nox libcli11-dev libexiv2-dev liblcms2-dev libopencv-core-dev libopencv-imgcodecs-dev
    libopencv-imgproc-dev libopencv-videoio-dev libpng-dev libtiff-dev libturbojpeg0-dev make nlohmann-json3-dev)
# What the tests need beyond those.
# shellcheck disable=SC2034
test_packages=(assimp-utils binutils clang doxygen libcmocka-dev libclang-rt-dev lintian pkg-config python3 python3-numpy python3-pil
    python3-venv shellcheck valgrind)

# install_packages NAME...: as root, or with sudo.
install_packages() {
    local lacking=() name
    for name in "$@"; do
        [ "$(dpkg-query --show --showformat='${db:Status-Status}' "$name" 2>/dev/null)" = installed ] || lacking+=("$name")
    done
    if [ ${#lacking[@]} -eq 0 ]; then
        return
    fi
    echo "installing Debian packages: ${lacking[*]}"
    local as_root=()
    if [ "$(id -u)" -ne 0 ]; then
        command -v sudo >/dev/null || { echo "need root or sudo to install: ${lacking[*]}" >&2; exit 1; }
        as_root=(sudo)
    fi
    "${as_root[@]}" apt-get update -qq
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
        apt-get install -qq -y --no-install-recommends "${lacking[@]}" >/dev/null
}

# reaches_pypi: whether Python's packages can be had, which Debian has not all of. Says so if not.
reaches_pypi() {
    python3 -c 'import urllib.request; urllib.request.urlopen("https://pypi.org/simple/maturin/", timeout=30)' 2>/dev/null ||
        { echo "pypi.org is out of reach: what needs its packages is left out"; return 1; }
}

# need_cargo: a Rust toolchain cannot come from Debian's packages here.
need_cargo() {
    if ! command -v cargo >/dev/null && [ -f "$HOME/.cargo/env" ]; then
        # shellcheck disable=SC1091
        . "$HOME/.cargo/env"
    fi
    command -v cargo >/dev/null || { echo "no cargo found: install a Rust toolchain (https://rustup.rs)" >&2; exit 1; }
}
