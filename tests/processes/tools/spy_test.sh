#!/usr/bin/env bash
# waymark-spy explains itself, and names in one line what is wrong.
set -u
spy=$1
failed=0
unset DISPLAY

# expect STATUS PATTERN ARGUMENTS...: on stdout for 0, else one line on stderr.
expect() {
  local status=$1 pattern=$2 output errors
  shift 2
  errors=$(mktemp)
  output=$("$spy" "$@" 2>"$errors")
  local got=$?
  ((status == 0)) || output=$(<"$errors")
  local lines
  lines=$(wc -l <"$errors")
  rm -f "$errors"
  if ((got != status)) || [[ $output != *$pattern* ]] ||
    ((status != 0 && lines != 1)); then
    echo "FAILED: $* gave $got: $output"
    failed=1
  fi
}

expect 0 'usage: waymark-spy' --help
expect 2 "unknown argument '--bad'" --bad
expect 2 'needs a URL' --lcm-url
# No display, or on a small machine no Java or no jars: one line each.
expect 2 'waymark-spy: ' --lcm-url 'udpm://239.255.76.67:7667?ttl=0'
exit $failed
