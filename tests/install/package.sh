#!/bin/sh
# Makes the .deb, installs it in a fresh root of the distribution it is made on, and runs what it brings there. Takes root,
# debootstrap and a mirror; with a third argument the root is left there.
# usage: package.sh SOURCE_FOLDER BUILD_FOLDER [ROOT]
set -eu
source=$1 build=$2
if [ "$(id -u)" -ne 0 ] || ! command -v debootstrap >/dev/null; then
    echo "skipped: this takes root and debootstrap"
    exit 77
fi
work=$(mktemp -d)
root=${3:-$work/root}
trap 'rm -rf "$work"' EXIT
cmake -S "$source" -B "$build" -G Ninja -DSHIVER_TESTS=OFF -DSHIVER_BENCH=OFF -DCMAKE_INSTALL_PREFIX=/usr >"$work/log"
cmake --build "$build" >>"$work/log"
(cd "$build" && cpack -G DEB -B "$work" >>"$work/log") || { cat "$work/log"; exit 1; }
package=$(echo "$work"/shiver_*.deb)
dpkg-deb --info "$package" | grep -E 'Package|Version|Depends|Recommends|Installed-Size'

. /etc/os-release
mirror=$(cat /etc/apt/sources.list /etc/apt/sources.list.d/* 2>/dev/null | grep -vE '^[[:space:]]*#' | grep -oE 'https?://[^ ]*' |
    grep -v security | head -n 1)
[ -x "$root/bin/sh" ] || debootstrap --variant=minbase --components=main,universe "$VERSION_CODENAME" "$root" "$mirror" >"$work/log" 2>&1 ||
    { tail "$work/log"; echo "skipped: no fresh root can be made from '$mirror'"; exit 77; }
cp "$package" "$root/shiver.deb"
cp "$source/tests/install/drop.c" "$source"/tests/install/*.py "$root/"
cat >"$root/try" <<'EOF'
set -eu
export DEBIAN_FRONTEND=noninteractive
apt-get update -qq
apt-get install -y -qq --no-install-recommends /shiver.deb python3-numpy >/log 2>&1 || { tail /log; exit 1; }
cd /tmp
shiver --version
shiver verify fall >verify.log
tail -n 1 verify.log
shiver run /usr/share/shiver/scenes/rigid/free_fall.yaml --quiet --force -o fall.h5
shiver info fall.h5 | head -n 3
for program in /*.py; do python3 "$program"; done
EOF
chroot "$root" sh /try
