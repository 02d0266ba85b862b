#!/bin/sh
# SPDX-License-Identifier: MIT
#
# Installs what is missing on Debian 12 with apt-get: `tools/setup.sh build` what the programs need, `build test` what
# the tests need as well, `check` what sanitizers, fuzzing and valgrind need, `gallery` what the pictures need. One
# line says what is installed; root is asked nothing. Anybody else gets the line to ask an administrator for, and
# exit code 2. Elsewhere than on Debian it leaves the matter to CMake, which names what it cannot find.
set -eu

build="gcc g++ make cmake ninja-build pkg-config libfyaml-dev libmuparser-dev libudunits2-dev libhdf5-dev \
libpng-dev libembree-dev libopenvdb-dev libboost-dev libcmocka-dev"
test="python3 python3-numpy python3-h5py python3-venv"
check="clang libclang-rt-14-dev libomp-14-dev valgrind"
gallery="imagemagick ffmpeg"

wanted=""
for word in "$@"; do
  case $word in
    build) wanted="$wanted $build" ;;
    test) wanted="$wanted $test" ;;
    check) wanted="$wanted $check" ;;
    gallery) wanted="$wanted $gallery" ;;
    *) echo "setup.sh: $word is none of build, test, check, gallery" >&2; exit 2 ;;
  esac
done

command -v dpkg-query >/dev/null || exit 0

# Packages that are installed come as "name ii"; those that are not may come with another state or not at all.
there=$(dpkg-query -W -f '${Package} ${db:Status-Abbrev}\n' $wanted 2>/dev/null | sed -n 's/ ii *$//p')
missing=""
for package in $wanted; do
  case "
$there
" in
    *"
$package
"*) ;;
    *) missing="$missing $package" ;;
  esac
done
[ -n "$missing" ] || exit 0

if [ "$(id -u)" -ne 0 ]; then
  echo "These packages are missing; ask an administrator for:  apt-get install --no-install-recommends$missing" >&2
  exit 2
fi

echo "set-up: installing with apt-get:$missing"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
export DEBIAN_FRONTEND=noninteractive
apt="apt-get -q -y -o DPkg::Lock::Timeout=120"
# Lists that cannot be renewed may still be good enough.
$apt update >"$log" 2>&1 || true
if ! $apt install --no-install-recommends $missing >>"$log" 2>&1 </dev/null; then
  tail -n 20 "$log" >&2
  echo "set-up: apt-get could not install:$missing" >&2
  exit 1
fi
