# Sourced by ./run and ./check: `set_up run|studio|check` makes .venv fit the checkout, once.
# Expects $root, the checkout's folder. Quiet when nothing is to do.
# shellcheck shell=sh
#
# .venv/.rigsim-run, -studio and -check are stamps: what the packages were installed from.
# .venv/.rigsim-unfinished stands while packages change; who finds it starts from an empty .venv.

venv=${root:?}/.venv
stamp=

say() { printf 'rigsim: %s\n' "$*" >&2; }
die() { say "error: $*"; exit 1; }
is_root() { [ "$(id -u)" = 0 ]; }
have() { command -v "$1" >/dev/null 2>&1; }

# everything that decides what .venv must hold; moved checkouts and new Pythons count
fingerprint() {
    sum=$(cat "$root/pyproject.toml" "$root/constraints.txt" | cksum)
    version=$("$venv/bin/python" -V 2>/dev/null) || version=none
    stamp="$sum $version $root"
}

is_stamped() {
    [ ! -e "$venv/.rigsim-unfinished" ] || return 1
    held=
    { IFS= read -r held <"$venv/.rigsim-$1"; } 2>/dev/null || return 1
    [ "$held" = "$stamp" ]
}

set_up() {
    fingerprint
    if is_stamped "$1"; then return 0; fi
    if [ -d "$venv" ]; then
        [ -w "$venv" ] || die "$venv cannot be written (read-only disk or another owner): use a copy that you own"
    else
        [ -w "$root" ] || die "$root cannot be written (read-only disk or another owner): use a copy that you own"
    fi
    # held by this file's descriptor, so it cannot outlive the process that holds it
    exec 9<"$root/tools/setup.sh"
    if have flock && ! flock -n 9; then
        say "waiting for another set-up of this checkout"
        flock 9
        fingerprint
    fi
    is_stamped "$1" || install_all "$1"
    exec 9<&-
}

install_all() {
    say "setting up .venv (once, about a minute)"
    trap 'exit 129' HUP
    trap 'exit 130' INT
    trap 'exit 143' TERM
    install_system_packages "$1"
    make_venv
    install_python_packages "$1"
    fingerprint
    write_stamp run
    case $1 in
        check) write_stamp studio; write_stamp check ;;
        studio) write_stamp studio ;;
    esac
    trap - HUP INT TERM
}

write_stamp() {
    printf '%s\n' "$stamp" >"$venv/.rigsim-$1.new"
    mv -f "$venv/.rigsim-$1.new" "$venv/.rigsim-$1"
}

# --- system packages: only as root, only with apt ---

apt_updated=
apt_install() {
    if [ -z "$apt_updated" ]; then
        apt-get update -qq >/dev/null 2>&1 || return 1
        apt_updated=yes
    fi
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$@" >/dev/null 2>&1
}

install_system_packages() {
    if ! is_root || ! have apt-get; then return 0; fi
    install_missing "GL" "rays only" libegl1 libopengl0 libgl1-mesa-dri
    if [ "$1" = check ]; then
        install_missing "a C++ compiler" "the test of the C++ example will fail" g++
        install_missing "a browser" "the tests of the page in a browser are left out" chromium chromium-driver
    fi
}

# install_missing WHAT CONSEQUENCE PACKAGES...
install_missing() {
    what=$1
    consequence=$2
    shift 2
    missing=
    for package in "$@"; do
        case $(dpkg-query -W -f '${Status}' "$package" 2>/dev/null) in
            *' installed') ;;
            *) missing="$missing $package" ;;
        esac
    done
    [ -n "$missing" ] || return 0
    # shellcheck disable=SC2086  # a list of words
    apt_install $missing || say "$what could not be installed (apt-get install$missing failed): $consequence"
}

# --- Python ---

mark_unfinished() {
    { mkdir -p "$venv" && touch "$venv/.rigsim-unfinished"; } 2>/dev/null || die "$venv cannot be written"
}

usable='import sys, ensurepip, venv; sys.exit(sys.version_info < (3, 11))'
new_enough='import sys; sys.exit(sys.version_info < (3, 11))'

find_python() {
    for python in python3.13 python3.12 python3.11 python3; do
        if "$python" -c "$1" >/dev/null 2>&1; then return 0; fi
    done
    return 1
}

make_venv() {
    # the scripts in a venv name its place, so one that was moved is of no use
    if [ -e "$venv/.rigsim-unfinished" ] \
        || ! grep -qsF -- "$venv" "$venv/bin/activate" \
        || ! "$venv/bin/python" -c "$new_enough" >/dev/null 2>&1 \
        || ! "$venv/bin/python" -m pip --version >/dev/null 2>&1; then
        if ! find_python "$usable" && is_root && have apt-get; then
            apt_install python3 python3-venv || die "apt-get could not install python3 (no network?): try again, or install Python >= 3.11"
        fi
        find_python "$usable" || explain_python
        mark_unfinished
        for part in bin etc include lib lib64 share pyvenv.cfg; do
            rm -rf "${venv:?}/$part"
        done
        "$python" -m venv "$venv" >"$venv/.rigsim-log" 2>&1 \
            || die "$python -m venv failed: $(tail -n 1 "$venv/.rigsim-log")"
    fi
}

explain_python() {
    if find_python "$new_enough"; then
        die "$(command -v "$python") has no venv module: install it (on Debian and Ubuntu: apt-get install python3-venv)"
    fi
    die "no Python >= 3.11 found: install one (on Debian 12 and Ubuntu 24.04: apt-get install python3 python3-venv)"
}

install_python_packages() {
    case $1 in
        check) extras=dev,vision,studio ;;
        studio) extras=vision,studio ;;
        *) extras=vision ;;
    esac
    mark_unfinished
    if (cd "$root" && PIP_USER=0 "$venv/bin/python" -m pip install --quiet --no-input --disable-pip-version-check \
        -c constraints.txt -e ".[$extras]") >"$venv/.rigsim-log" 2>&1; then
        rm -f "$venv/.rigsim-unfinished"
        return 0
    fi
    # pip undoes what it began when it fails by itself; only a kill leaves .venv unfinished
    rm -f "$venv/.rigsim-unfinished"
    reason=$(grep '^ERROR' "$venv/.rigsim-log" | head -n 1 | cut -c 1-200)
    if grep -q 'SSLError' "$venv/.rigsim-log"; then
        reason="the package index's certificate is not trusted here (PIP_CERT names the right one to pip)"
    elif grep -qE 'NewConnectionError|NameResolutionError|name resolution|ProxyError|ConnectTimeout' \
        "$venv/.rigsim-log"; then
        reason="no network: the Python packages could not be downloaded"
    fi
    die "${reason:-pip install failed}: see .venv/.rigsim-log, then try again"
}
