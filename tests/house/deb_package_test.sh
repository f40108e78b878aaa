#!/usr/bin/env bash
# The Debian package: made, complete, and with the libraries its programs load
# as dependencies.
#
#   deb_package_test.sh BUILD_FOLDER SCRATCH_FOLDER PROGRAM…
set -euo pipefail
build=$1
scratch=$2
shift 2
rm -rf "$scratch"
mkdir -p "$scratch"
trap 'rm -rf "$scratch"' EXIT

fail() { echo "deb_package_test: $*"; exit 1; }

(cd "$build" && cpack -G DEB -B "$scratch" >"$scratch/cpack.log" 2>&1) ||
  { cat "$scratch/cpack.log"; fail "cpack failed"; }
package=$(find "$scratch" -maxdepth 1 -name 'waymark_*.deb')
[[ -f $package ]] || fail "no package"

contents=$(dpkg-deb -c "$package")
for path in "${@/#/usr/bin/}" usr/bin/waymark-spy \
  usr/share/doc/waymark/{copyright,LICENSE,NOTICE,README.md,CHANGELOG.md} \
  usr/lib/cmake/Waymark/WaymarkConfig.cmake \
  usr/include/waymark_lcmtypes/waymark/pose_t.hpp \
  usr/lib/python3/dist-packages/waymark/pose_t.py \
  usr/share/waymark/lcmtypes/pose_t.lcm; do
  grep -qE " \./$path\$" <<<"$contents" || fail "$path is not in the package"
done
for path in usr/local tests/ _test '\.o$'; do
  ! grep -qE " \./.*$path" <<<"$contents" || fail "the package holds $path"
done

depends=$(dpkg-deb -f "$package" Depends)
libraries=(libc6 libstdc++6 liblcm1 libyaml-cpp0.7)
# Ceres itself is linked statically, what it stands on is not.
[[ " $* " != *" batch_refiner "* ]] || libraries+=(libcholmod3)
for library in "${libraries[@]}"; do
  grep -qF "$library" <<<"$depends" || fail "does not depend on $library"
done
grep -q Apache <(dpkg-deb --fsys-tarfile "$package" |
  tar -xO ./usr/share/doc/waymark/copyright) || fail "no licence named"
echo "deb_package_test: passed: $(basename "$package"), depends on $depends"
