# What demos share: a network for LCM, a place for their output, processes by
# the launcher. Sourced by bash scripts with `set -euo pipefail`, which set
#   session_name  for messages ("demo"),
#   session_out   the folder of all output,
#   root, bin     the project and its executables.

say() { printf '%s\n' "$*"; }
refuse() { printf '%s: %s\n' "$session_name" "$*" >&2; exit 2; }

# session_enter_network INSIDE SCRIPT [ARGUMENTS...]: without a multicast route
# LCM cannot start. A network of the script's own has one, and ends with it: the
# script is started anew there, with --inside. INSIDE: 1 where it has been.
session_enter_network() {
  local inside=$1
  shift
  ((!inside)) || return 0
  ! ip route get 239.255.76.67 >/dev/null 2>&1 || return 0
  local own=(unshare --net)
  ((EUID == 0)) || own=(unshare --map-root-user --net)
  if "${own[@]}" true 2>/dev/null; then
    say "$session_name: no multicast route here: running in a network" \
      "namespace of its own"
    exec "${own[@]}" bash -c 'ip link set lo up &&
      ip route add 224.0.0.0/4 dev lo && exec "$@"' bash "$@" --inside
  fi
  refuse "LCM needs a multicast route: sudo ip route add 224.0.0.0/4 dev lo"
}

# Prints an LCM URL with a port that nobody listens on: other LCM programs hear
# nothing of this.
session_url() {
  local port
  for ((port = 20000 + $$ % 20000; ; ++port)); do
    grep -q ":$(printf '%04X' "$port") " /proc/net/udp || break
  done
  printf 'udpm://239.255.76.67:%d?ttl=0\n' "$port"
}

launcher_pid=0
player_pid=0
session_cleanup() {
  trap - EXIT INT TERM HUP
  if ((player_pid)); then kill "$player_pid" 2>/dev/null || true; fi
  if ((launcher_pid)); then
    kill "$launcher_pid" 2>/dev/null || true
    wait "$launcher_pid" 2>/dev/null || true
  fi
}

# One at a time in one folder; what was started ends with the script.
session_begin() {
  mkdir -p "$session_out" 2>/dev/null || refuse "$session_out: cannot be made"
  exec 9>"$session_out/.lock"
  flock -n 9 ||
    refuse "another demo is writing to $session_out; use --out FOLDER"
  trap session_cleanup EXIT
  session_ends_on INT TERM HUP
}

session_ends_on() {
  trap 'session_cleanup; echo "$session_name: interrupted" >&2; exit 130' "$@"
}

# The newest line that each process wrote, where something went wrong.
session_blame() {
  local file
  for file in "$1"/*.txt; do
    [[ -s $file ]] || continue
    printf '  %s: %s\n' "$(basename "$file" .txt)" "$(tail -n 1 "$file")" >&2
  done
}

# session_launch FOLDER: starts the processes of FOLDER/list.
session_launch() {
  # Batch results of long recordings take their time at the end.
  # In a session of their own: a Ctrl-C in this terminal is for the script.
  WAYMARK_STOP_S=60 setsid "$root/procman/launcher.sh" "$1/list" "$1" 9>&- &
  launcher_pid=$!
}

# session_ready FOLDER URL LOG PROCESS...: waits until the processes have
# published STATUS and the recorder has written it to LOG: it listens then.
session_ready() {
  local folder=$1 url=$2 log=$3
  shift 3
  "$bin/waymark-wait" status "$@" --timeout 60 --lcm-url "$url" ||
    { session_blame "$folder"; return 1; }
  local deadline=$((SECONDS + 20))
  until [[ -s $log ]]; do
    if ((SECONDS > deadline)); then
      say "$session_name: lcm-logger writes nothing to $log" >&2
      session_blame "$folder"
      return 1
    fi
    sleep 0.1
  done
}

# session_end FOLDER: stops the processes, the recorder last.
session_end() {
  kill "$launcher_pid"
  wait "$launcher_pid" || { launcher_pid=0; session_blame "$1"; return 1; }
  launcher_pid=0
}
