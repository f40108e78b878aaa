#!/usr/bin/env bash
# ./run explains itself, refuses bad input in one line with status 2, and
# counts tests truly.
#
#   run_test.sh SOURCE_FOLDER SCRATCH_FOLDER
set -euo pipefail
run=$1/run
scratch=$2
rm -rf "$scratch"
mkdir -p "$scratch/bin"
cd "$scratch"

fail() { echo "run_test: $*"; exit 1; }

expect_help() {
  "$run" "$@" --help >out 2>err || fail "$* --help: status $?"
  [[ -s out ]] || fail "$* --help says nothing"
}

# expect_refused WORD ARGUMENTS...: status 2, one line on stderr with WORD.
expect_refused() {
  local word=$1 status=0
  shift
  "$run" "$@" >out 2>err || status=$?
  [[ $status == 2 ]] || fail "$*: status $status, not 2"
  [[ $(wc -l <err) == 1 ]] || fail "$*: $(wc -l <err) lines: $(cat err)"
  grep -qF -- "$word" err || fail "$*: does not say '$word': $(cat err)"
}

expect_help
for command in setup build test demo bench spy replay; do
  expect_help "$command"
done
expect_refused "no_such_tool" no_such_tool
expect_refused "no log named" replay
expect_refused "missing.lcm" replay missing.lcm
expect_refused "nonsense" setup nonsense

# Installing, on a copy beside which dpkg-query, apt-get and sudo are played by
# small scripts: g++ alone is installed; apt-get knows no package before it has
# been updated.
mkdir clone
cp "$run" clone/run
printf '#!/bin/sh\necho "installed g++"\n' >bin/dpkg-query
printf '#!/bin/sh\nexit 1\n' >bin/sudo
cat >bin/apt-get <<'APT'
#!/bin/sh
echo "$*" >>calls
case "$*" in
  *update*) touch updated ;;
  *install*) test -e updated ;;
esac
APT
chmod +x bin/*
if ((EUID == 0)); then
  PATH=$PWD/bin:$PATH clone/run setup >out 2>err || fail "setup: $(cat err)"
  [[ $(grep -c ' install ' calls) == 2 && $(grep -c update calls) == 1 ]] ||
    fail "expected install, update, install: $(cat calls)"
  grep -q ' -y install --no-install-recommends .*cmake' calls ||
    fail "$(cat calls)"
  ! grep -qF ' g++' calls || fail "installs what is there: $(cat calls)"
fi

# Without root and sudo: the one apt line, status 2.
as_user=()
if ((EUID == 0)); then
  command -v setpriv >/dev/null || { echo "run_test: passed"; exit 0; }
  as_user=(setpriv --reuid 65534 --clear-groups)
fi
status=0
PATH=$PWD/bin:$PATH "${as_user[@]}" bash clone/run setup >out 2>err || status=$?
if grep -q 'Permission denied' err; then
  echo "run_test: a plain user cannot read this folder; that part is left out"
else
  [[ $status == 2 ]] || fail "setup without root: $status: $(cat err)"
  [[ $(wc -l <err) == 1 ]] || fail "setup without root: $(cat err)"
  grep -q 'sudo apt-get install -y .*cmake' err || fail "$(cat err)"
  ! grep -qF ' g++' err || fail "asks for what is installed: $(cat err)"
fi
echo "run_test: passed"
