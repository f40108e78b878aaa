#!/usr/bin/env bash
# Runs every fuzz target with clang's libFuzzer, address and undefined-
# behaviour sanitizers.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."

usage() {
  cat <<'TEXT'
usage: tests/fuzz/run.sh [SECONDS [TARGET…]]

Builds the fuzz targets (preset asan, into build-asan) and runs each, or those
named, for SECONDS (default 60), one per core at a time. What it learns stays
in build-asan/corpus/<target> for the next run. Prints the executions of each
target; inputs that failed go to build-asan/findings: copy them, reduced by
`build-asan/fuzz/<target>_fuzz -minimize_crash=1 FILE`, to
tests/fuzz/regressions/<target>/ together with the repair.
Needs clang-14 and libclang-rt-14-dev. Exit status: 0 no finding, 1 findings.
TEXT
}

case ${1:-} in
  -h | --help) usage; exit 0 ;;
esac
seconds=${1:-60}
[[ $seconds =~ ^[1-9][0-9]*$ ]] ||
  { echo "run.sh: '$seconds' is not a number of seconds" >&2; exit 2; }
(($# == 0)) || shift

build=$PWD/build-asan
mkdir -p "$build/findings" "$build/reports"
{ cmake --preset asan && nice cmake --build "$build" \
  --target waymark_fuzz_targets; } >"$build/build.log" 2>&1 ||
  { grep -A20 -E 'FAILED|Error' "$build/build.log" | head -n 40; exit 1; }

targets=("$@")
if ((${#targets[@]} == 0)); then
  for program in "$build"/fuzz/*_fuzz; do
    name=${program##*/}
    targets+=("${name%_fuzz}")
  done
fi

# Libraries of the system are built without sanitizers, so marks on the unused
# part of vectors that cross into them would be wrong.
export ASAN_OPTIONS=detect_container_overflow=0
export UBSAN_OPTIONS=print_stacktrace=1

# An input takes a second at most; 60 leave room for a machine that does other
# things first. Without entropic=0 libFuzzer spends much of its time weighing the
# thousands of features of each input; naming new functions is as slow.
run_target() {
  local name=$1 corpus=$build/corpus/$1
  local regressions=tests/fuzz/regressions/$1
  mkdir -p "$corpus"
  WAYMARK_WRITE_SEEDS=$corpus "$build/fuzz/${name}_fuzz"
  [[ ! -d $regressions ]] || corpus+=" $regressions"
  # shellcheck disable=SC2086  # two folders
  nice -n 19 "$build/fuzz/${name}_fuzz" $corpus \
    -max_total_time="$seconds" -timeout=60 -rss_limit_mb=2048 -max_len=8192 \
    -entropic=0 -print_funcs=0 -print_final_stats=1 -artifact_prefix="$build/findings/$name-" \
    >"$build/reports/$name.txt" 2>&1
}

failed=0
report() {
  local name=$1 status=$2 executions
  executions=$(sed -n 's/^stat::number_of_executed_units: *//p' \
    "$build/reports/$name.txt")
  if ((status == 0)); then
    printf '%-20s %12s executions\n' "$name" "${executions:-0}"
  else
    failed=$((failed + 1))
    printf '%-20s %12s executions, FINDING: %s\n' "$name" "${executions:-?}" \
      "$(grep -m1 -E 'ERROR|runtime error|property|what\(\)' \
        "$build/reports/$name.txt" || echo "see build-asan/reports/$name.txt")"
  fi
}

jobs=$(nproc)
declare -A running=()
finish_one() {
  local pid status=0
  wait -n -p pid "${!running[@]}" || status=$?
  report "${running[$pid]}" "$status"
  unset "running[$pid]"
}
for name in "${targets[@]}"; do
  [[ -x $build/fuzz/${name}_fuzz ]] ||
    { echo "run.sh: no target '$name'" >&2; exit 2; }
  ((${#running[@]} < jobs)) || finish_one
  run_target "$name" &
  running[$!]=$name
done
while ((${#running[@]})); do finish_one; done

echo "fuzz: ${#targets[@]} targets, $seconds s each, $failed with findings"
((failed == 0))
