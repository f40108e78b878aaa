#!/usr/bin/env bash
# Everything to run before a change goes in.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.."

usage() {
  cat <<TEXT
usage: tests/check.sh [--full] [--fuzz-seconds N] [STEP…]

Without a step: format, layers, build, unit, tidy (changed files only).
--full: format, layers, build, all tests, tidy (all files), asan, tsan, fuzz.
A step's name runs that step alone.

  format   clang-format on all tracked sources
  layers   what may include what
  build    the release build, warnings as errors
  unit     tests with the label unit
  test     all tests
  tidy     clang-tidy on files changed since the branch left main
  tidy-all clang-tidy on all files
  asan     build and test with address and undefined-behaviour sanitizers
  tsan     build and test with the thread sanitizer
  fuzz     every fuzz target for N seconds (default 300)
TEXT
}

fuzz_seconds=300
steps=()
full=false
while (($#)); do
  case $1 in
    --help | -h) usage; exit 0 ;;
    --full) full=true ;;
    --fuzz-seconds)
      [[ ${2:-} =~ ^[1-9][0-9]*$ ]] ||
        { echo "check: --fuzz-seconds needs a positive number" >&2; exit 2; }
      fuzz_seconds=$2
      shift
      ;;
    format | layers | build | unit | test | tidy | tidy-all | asan | tsan | \
      fuzz) steps+=("$1") ;;
    *) echo "check: unknown step '$1'; see --help" >&2; exit 2 ;;
  esac
  shift
done
if ((${#steps[@]} == 0)); then
  steps=(format layers build unit tidy)
  ! $full || steps=(format layers build test tidy-all asan tsan fuzz)
fi

jobs=$(nproc)
rooms=(estimation planner drivers processes logs procman tests)
sources() { git ls-files -- "${rooms[@]/%//*.$1}"; }

# Sources that differ from where this branch left main, and new ones.
changed_sources() {
  local base
  base=$(git merge-base HEAD origin/main 2>/dev/null ||
    git merge-base HEAD main 2>/dev/null || git rev-parse HEAD)
  {
    git diff --name-only --diff-filter=d "$base"
    git ls-files --others --exclude-standard
  } | grep -E "^($(IFS='|'; echo "${rooms[*]}"))/.*\.cc$" || true
}

check_format() {
  { sources cc; sources h; } | xargs clang-format --dry-run -Werror
}

check_layers() {
  cmake -DROOT="$PWD" -P tests/layers_test.cmake
}

check_build() { WAYMARK_WERROR=ON ./run build; }
check_unit() { WAYMARK_WERROR=ON ./run test -L unit; }
check_test() { WAYMARK_WERROR=ON ./run test; }

# tidy FILE...: with the flags of the release build. Only what is compiled has
# flags; the others (fuzz targets without clang) are left out.
tidy() {
  local file files=()
  for file in "$@"; do
    ! grep -qF "$PWD/$file\"" build/compile_commands.json || files+=("$file")
  done
  ((${#files[@]})) || { echo "no compiled file to look at"; return 0; }
  # Findings stand alone: clang's count of hidden warnings is left out.
  printf '%s\n' "${files[@]}" |
    xargs -P "$jobs" -n 1 clang-tidy -p build --quiet 2>&1 |
    sed -E '/^[0-9]+ warnings? (generated|treated)|^Suppressed|^$/d'
}
check_tidy() { mapfile -t files < <(changed_sources); tidy "${files[@]}"; }
check_tidy_all() { mapfile -t files < <(sources cc); tidy "${files[@]}"; }

# A sanitizer slows code down five to fifteen times: tests that measure time
# or rebuild the project (slow) say nothing more under it.
sanitized() {
  cmake --preset "$1" >/dev/null || return 1
  cmake --build --preset "$1" -j "$jobs" >"build-$1/build.log" 2>&1 ||
    { grep -A20 '^FAILED' "build-$1/build.log" | head -n 40; return 1; }
  ctest --preset "$1" -j "$jobs" -LE slow --output-on-failure
}
check_asan() {
  ASAN_OPTIONS=detect_stack_use_after_return=1:strict_string_checks=1 \
    UBSAN_OPTIONS=print_stacktrace=1 sanitized asan
}
check_tsan() {
  local options=halt_on_error=1:second_deadlock_stack=1
  TSAN_OPTIONS=$options:suppressions=$PWD/tests/tsan_suppressions.txt \
    sanitized tsan
}

check_fuzz() { tests/fuzz/run.sh "$fuzz_seconds"; }

./run setup check
failed=()
for step in "${steps[@]}"; do
  begin=$SECONDS
  printf '== %s\n' "$step"
  if "check_${step/-/_}"; then
    printf '== %s passed, %d s\n' "$step" $((SECONDS - begin))
  else
    printf '== %s FAILED, %d s\n' "$step" $((SECONDS - begin))
    failed+=("$step")
  fi
done
if ((${#failed[@]})); then
  echo "check: failed: ${failed[*]}"
  exit 1
fi
echo "check: all passed: ${steps[*]}"
