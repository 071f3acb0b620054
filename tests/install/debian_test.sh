#!/bin/sh
# Makes the Debian packages of a build and uses them unpacked: debian_test.sh BUILD SOURCE. They hold files below /usr only, which
# name neither the place of the sources nor that of the build; command, Python package and wheel give one plane, bit for bit.
#
# debian_test.sh BUILD SOURCE FOLDER, as root, where FOLDER is a bare Debian 12 (debootstrap --variant=minbase bookworm FOLDER):
# installs them there by apt, which finds what they depend on, uses them, and removes them again without a trace.
set -eu
build=$(realpath "$1") source=$(realpath "$2") debian=${3:-}
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cd "$place"
export LC_ALL=C.UTF-8

fail() { echo "packages: $*" >&2; exit 1; }

# Compressed fast; and by the rules of another generator, for which CPack does not build anew what other tests are using.
cpack --config "$build/CPackConfig.cmake" -B "$place" -D "CPACK_COMPONENTS_ALL=command;python" \
  -D CPACK_DEBIAN_COMPRESSION_TYPE=gzip -D CPACK_CMAKE_GENERATOR=Ninja >packed 2>&1 || fail "$(cat packed)"
for package in rosin python3-rosin; do
  file=$(echo ${package}_*.deb)
  dpkg-deb -f "$file" >control
  for field in 'Description: Dynamic friction' 'Depends: .*libnetcdf' 'Maintainer: ' 'Section: '; do
    grep -q "^$field" control || fail "$package has no '$field' in $(cat control)"
  done
  dpkg-deb -c "$file" | awk '$6 !~ "^\\./usr/" { print $6 }' >outside
  [ ! -s outside ] || fail "$package has files outside /usr: $(cat outside)"
  dpkg-deb -x "$file" root
done
for needed in python3-numpy python3-xarray python3-netcdf4 'python3 (>= 3'; do
  grep -q "^Depends: .*$needed" control || fail "python3-rosin does not depend on $needed"
done
grep -q '^Recommends: python3-matplotlib' control || fail "python3-rosin does not recommend matplotlib"
for file in bin/rosin share/man/man1/rosin.1.gz share/doc/rosin/copyright share/doc/rosin/docs/index.md share/rosin/cases/board \
  share/rosin/examples/bristol-board-plane.toml lib/python3/dist-packages/rosin/__init__.py share/doc/python3-rosin/copyright; do
  [ -e "root/usr/$file" ] || fail "there is no /usr/$file"
done
named=$(grep -rlFe "$source/" -e "$build/" root || true)
[ -z "$named" ] || fail "these name the place where they were built: $named"

if [ -z "$debian" ]; then
  PATH=$place/root/usr/bin:$PATH PYTHONPATH=$place/root/usr/lib/python3/dist-packages PYTHONDONTWRITEBYTECODE=1 \
    /usr/bin/python3 "$source/tests/install/same_plane.py" root/usr/share/rosin/examples/bristol-board-plane.toml >told
  grep -q "the same bits: $place/root/usr/lib" told || fail "$(cat told)"
  python=$(sed -n 's/^set(CPACK_WHEEL_PYTHON "\(.*\)")$/\1/p' "$build/CPackConfig.cmake")
  "$python" -m zipfile -e rosin-*.whl wheel
  PATH=$place/root/usr/bin:$PATH PYTHONPATH=$place/wheel PYTHONDONTWRITEBYTECODE=1 \
    "$python" "$source/tests/install/same_plane.py" root/usr/share/rosin/examples/bristol-board-plane.toml >told
  grep -q "the same bits: $place/wheel" told || fail "$(cat told)"
  root/usr/bin/rosin verify slip-weakening-recurrence --out verified >told || fail "$(cat told)"
  exit
fi

mount -t proc proc "$debian/proc"
trap 'umount "$debian/proc"; rm -rf "$place" "$debian/tmp/rosin"' EXIT
mkdir "$debian/tmp/rosin"
cp ./*.deb "$source/tests/install/same_plane.py" "$debian/tmp/rosin"
chroot "$debian" sh -eu <<'END_OF_CHROOT'
cd /tmp/rosin
export DEBIAN_FRONTEND=noninteractive
apt-get -q update >log
apt-get -q install -y --no-install-recommends python3-matplotlib gnuplot-nox ./rosin_*.deb ./python3-rosin_*.deb >>log 2>&1 || { tail -n 20 log; exit 1; }
python3 same_plane.py /usr/share/rosin/examples/bristol-board-plane.toml
rosin verify slip-weakening-recurrence --out verified
apt-get -q remove -y rosin python3-rosin >>log 2>&1
left=$(find /usr -path '*rosin*' ! -path '/usr/share/doc*')
[ -z "$left" ] || { echo "left behind: $left"; exit 1; }
END_OF_CHROOT
