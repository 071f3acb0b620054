#!/bin/sh
# Installs a build into a new folder and uses it from there: install_test.sh BUILD. The command finds its cases and draws an
# example; programs outside the tree find the library through CMake and through pkg-config, and all its headers.
set -eu
build=$(realpath "$1")
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cd "$place"

fail() { echo "install: $*" >&2; exit 1; }

cmake --install "$build" --prefix "$place/there" >installed
mv there here # what knows its first place by heart breaks
share=$place/here/share/rosin

# The command, its examples, its cases, its pages.
here/bin/rosin map "$share/examples/bristol-board-plane.toml" --set map.x.points=3 --set map.y.points=3 --out map --quiet
[ -s map/result.json ] || fail "a map of an installed example left no result"
here/bin/rosin verify slip-weakening-recurrence coulomb-damped --out verify >verified ||
  fail "installed cases do not agree: $(cat verified)"
for page in man/man1/rosin.1 bash-completion/completions/rosin zsh/site-functions/_rosin fish/vendor_completions.d/rosin.fish; do
  [ -s "here/share/$page" ] || fail "there is no $page"
done
if command -v groff >/dev/null; then
  complaints=$(groff -man -Tutf8 -ww here/share/man/man1/rosin.1 2>&1 >/dev/null)
  [ -z "$complaints" ] || fail "the man page: $complaints"
fi
if command -v bash >/dev/null; then
  completed=$(bash -c '. here/share/bash-completion/completions/rosin
    COMP_WORDS=(rosin map --exa); COMP_CWORD=2; _rosin; echo "${COMPREPLY[@]}"
    COMP_WORDS=(rosin laws sp); _rosin; echo "${COMPREPLY[@]}"')
  [ "$completed" = "--exact
spinodal" ] || fail "bash completes to '$completed'"
fi

# A law of one's own in a project outside the tree. One folder has the name of a folder of rosin.
mkdir -p mine/core
cp "$share/examples/your_own_law.cpp" "$share/examples/readme.cpp" mine
echo '#error a file of the user, not of rosin' >mine/core/dual.hpp
cat >mine/CMakeLists.txt <<'END'
cmake_minimum_required(VERSION 3.25)
project(mine LANGUAGES CXX)
find_package(rosin 0.1 REQUIRED)
add_executable(your_own_law your_own_law.cpp)
target_include_directories(your_own_law PRIVATE ${PROJECT_SOURCE_DIR})
target_link_libraries(your_own_law PRIVATE rosin::rosin)
END
cmake -S mine -B mine/build -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$place/here" >configured 2>&1 || fail "$(cat configured)"
cmake --build mine/build --verbose >built 2>&1 || fail "$(cat built)"
mine/build/your_own_law >told
grep -q 'it sticks and slips every' told || fail "the law of one's own says: $(cat told)"

# The command with an oscillator of one's own.
mkdir own
cp "$share/examples/your_own_oscillator.cpp" own
cat >own/CMakeLists.txt <<'END'
cmake_minimum_required(VERSION 3.25)
project(own LANGUAGES CXX)
find_package(rosin 0.1 REQUIRED COMPONENTS app)
add_executable(your_own_oscillator your_own_oscillator.cpp)
target_link_libraries(your_own_oscillator PRIVATE rosin::app)
END
cmake -S own -B own/build -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$place/here" >configured 2>&1 || fail "$(cat configured)"
cmake --build own/build --verbose >built 2>&1 || fail "$(cat built)"
cat >rotors.toml <<'END'
law = { type = "hyperbolic", mu_s = 0.4, delta = 0.5 }
oscillator = { type = "two-rotors", damping = 0.1 }
drive = { speed = 0.5, normal_load = 40 }
END
own/build/your_own_oscillator stability rotors.toml --no-pictures --out rotors >told || fail "the oscillator of one's own says: $(cat told)"
grep -q 'friction force 12.8 N' told || fail "the oscillator of one's own says: $(cat told)"

# Through pkg-config, and every header there is.
PKG_CONFIG_PATH=$place/$(dirname "$(find here -name rosin.pc)")
export PKG_CONFIG_PATH
(cd here/include && find rosin -name '*.hpp' | sort | sed 's/.*/#include <&>/') >all.cpp
${CXX:-c++} $(pkg-config --cflags rosin) -fsyntax-only all.cpp || fail "a header lacks what it needs"
${CXX:-c++} -O2 $(pkg-config --cflags rosin) mine/readme.cpp -o readme $(pkg-config --libs rosin)
./readme >told
grep -q 'with a period of 22.58705' told || fail "the example of the README says: $(cat told)"
if grep -rlE "$build|#include \"(core|laws|oscillators|solvers|analysis|app)/" here/include here/lib/cmake here/lib/pkgconfig; then
  fail "these files name the place where rosin was built, or folders without rosin/"
fi
