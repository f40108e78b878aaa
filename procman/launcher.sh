#!/usr/bin/env bash
# Small launcher of processes, until the deputy does this.
#
# usage: launcher.sh LIST LOG_FOLDER
#
# LIST has one process a line, "name: command"; blank lines and lines that
# start with # are left out. Output goes to LOG_FOLDER/name.txt, what the
# launcher does to LOG_FOLDER/launcher.txt.
#
# A process that crashes is started again, after 0.5 s, then twice as long each
# time up to 8 s; one that ran for 10 s counts as new. Exit codes 0 (done) and
# 2 (bad input, which a restart does not mend) end it.
#
# SIGTERM or SIGINT stops the processes one after the other, the last of the
# list first: each gets SIGTERM, and after WAYMARK_STOP_S seconds (10) SIGKILL.
# The launcher ends when no process is left. Exit code 0; 1 where a process
# failed for good or had to be killed; 2 for bad input.
set -u

refuse() { printf 'launcher: %s\n' "$*" >&2; exit 2; }

(($# == 2)) || refuse "usage: launcher.sh LIST LOG_FOLDER"
list=$1
folder=$2
stop_ms=$((${WAYMARK_STOP_S:-10} * 1000))
[[ -r $list ]] || refuse "$list: cannot be read"
mkdir -p "$folder" 2>/dev/null || refuse "$folder: cannot be made"

names=()
commands=()
number=0
while IFS= read -r line || [[ -n $line ]]; do
  number=$((number + 1))
  [[ $line =~ ^[[:space:]]*(#|$) ]] && continue
  [[ $line =~ ^([A-Za-z0-9_-]+):[[:space:]]+(.+)$ ]] ||
    refuse "$list:$number: expected 'name: command', got '$line'"
  for name in "${names[@]+"${names[@]}"}"; do
    [[ $name != "${BASH_REMATCH[1]}" ]] ||
      refuse "$list:$number: second process of name '$name'"
  done
  names+=("${BASH_REMATCH[1]}")
  commands+=("${BASH_REMATCH[2]}")
done <"$list"
((${#names[@]})) || refuse "$list: no process in it"

# Per process, by its index: pid (0: not running), start, wait and due time.
pids=()
started_ms=()
backoff_ms=()
due_ms=()
failed=0
stopping=0
trap 'stopping=1' TERM INT HUP

now_ms() { local t=${EPOCHREALTIME/[.,]/}; echo "${t%???}"; }
note() { printf '%(%H:%M:%S)T %s\n' -1 "$*" >>"$folder/launcher.txt"; }

# A session of its own, so that Ctrl-C reaches the launcher alone; it dies with
# the launcher, also where that is killed.
start() {
  local i=$1
  setsid setpriv --pdeathsig TERM bash -c "exec ${commands[i]}" \
    </dev/null >>"$folder/${names[i]}.txt" 2>&1 &
  pids[i]=$!
  started_ms[i]=$(now_ms)
  due_ms[i]=0
  note "${names[i]}: started, pid ${pids[i]}"
}

# A child's end: again, or for good.
ended() {
  local i=$1 code=$2
  pids[i]=0
  note "${names[i]}: ended with $code"
  if ((stopping)); then
    # Ended by our own signal, or properly: as asked for.
    ((code == 0 || code == 128 + 15 || code == 128 + 9)) || failed=1
    return
  fi
  ((code)) || return
  if ((code == 2)); then
    failed=1
    printf 'launcher: %s: %s\n' "${names[i]}" \
      "$(tail -n 1 "$folder/${names[i]}.txt")" >&2
    return
  fi
  local now
  now=$(now_ms)
  if ((now - started_ms[i] >= 10000)); then backoff_ms[i]=500; fi
  due_ms[i]=$((now + backoff_ms[i]))
  printf 'launcher: %s ended with %d; again in %d ms\n' "${names[i]}" "$code" \
    "${backoff_ms[i]}" >&2
  backoff_ms[i]=$((backoff_ms[i] * 2 > 8000 ? 8000 : backoff_ms[i] * 2))
}

# Takes note of every child that has ended.
reap() {
  local i code
  for i in "${!names[@]}"; do
    ((pids[i])) || continue
    kill -0 "${pids[i]}" 2>/dev/null && continue
    wait "${pids[i]}"
    code=$?
    ended "$i" "$code"
  done
}

stop() {
  local i waited
  for ((i = ${#names[@]} - 1; i >= 0; --i)); do
    reap
    ((pids[i])) || continue
    kill -TERM "${pids[i]}" 2>/dev/null
    waited=0
    while kill -0 "${pids[i]}" 2>/dev/null && ((waited < stop_ms)); do
      sleep 0.05
      waited=$((waited + 50))
    done
    if kill -KILL "${pids[i]}" 2>/dev/null; then
      printf 'launcher: %s did not stop within %d ms: killed\n' \
        "${names[i]}" "$stop_ms" >&2
      failed=1
    fi
    reap
  done
}

for i in "${!names[@]}"; do
  backoff_ms[i]=500
  start "$i"
done
while ((!stopping)); do
  reap
  alive=0
  for i in "${!names[@]}"; do
    if ((due_ms[i] && due_ms[i] <= $(now_ms))); then start "$i"; fi
    if ((pids[i] || due_ms[i])); then alive=1; fi
  done
  ((alive)) || exit "$failed"
  sleep 0.1 &
  wait $! # A trap ends it at once; a plain sleep would be waited for.
done
stop
exit "$failed"
