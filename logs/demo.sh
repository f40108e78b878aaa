#!/usr/bin/env bash
# Plays recordings of real robots through LCM and shows what came of it.
# Started by ./run demo, which builds first.
set -euo pipefail

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)
bin=${WAYMARK_BUILD:-$root/build}/bin
data=${WAYMARK_DATA:-$root/../shared/data}
out=$root/out/demo
session_name=demo
source "$root/procman/session.sh"
speed=6
wanted=()

usage() {
  cat <<TEXT
usage: ./run demo [NAME...] [--speed X] [--out FOLDER]
       ./run demo drive | corridor [ARGUMENTS]

Imports recordings of real robots, plays them by lcm-logplayer to pose_filter
and batch_refiner, records by lcm-logger, evaluates, and writes
FOLDER/report.html (out/demo). NAME: lego, square, circular, ivanjko, maebot,
or one of logs/samples; without a name all recordings. They are looked for in
WAYMARK_DATA (shared/data beside the clone); without them logs/samples are
played. --speed: multiple of the recorded speed (6).

With drive: a simulated robot in an office, live; with corridor: one that finds
its way by the lines of a corridor. See ./run demo drive --help.
TEXT
}
inside=0
arguments=("$@")
while (($#)); do
  case $1 in
    -h | --help) usage; exit 0 ;;
    --speed)
      (($# > 1)) || refuse "--speed needs a number"
      speed=$2
      shift
      ;;
    --out)
      [[ -n ${2-} ]] || refuse "--out needs a folder"
      out=$(realpath -m "$2")
      shift
      ;;
    --inside) inside=1 ;; # In the network namespace that this script made.
    -*) refuse "unknown flag '$1' (see --help)" ;;
    *) wanted+=("$1") ;;
  esac
  shift
done
[[ $speed =~ ^[0-9]+(\.[0-9]+)?$ && ! $speed =~ ^0*(\.0*)?$ ]] ||
  refuse "--speed: '$speed' is no positive number"
for tool in waymark-log waymark-wait pose_filter batch_refiner; do
  [[ -x $bin/$tool ]] || refuse "$bin/$tool is missing: run ./run build"
done

# ---- what to play ----------------------------------------------------------

# name|input|flags of the importer. Fixes are samples of the reference with
# noise added: 2 cm by default, 5 mm where motion capture is the reference, or
# the fixes would be worse than these robots' dead reckoning. The LEGO robot's
# camera lags by what waymark-refine finds as its time offset.
recordings=(
  "lego|brenner_lego_robot4|--reference-delay 0.19"
  "square|optiodom_diffdrive/square/230620202042/230620202042_run-01.csv|--noise-m 0.005"
  "circular|optiodom_diffdrive/circular/231220200121/231220200121_run-01.csv|--noise-m 0.005"
  "ivanjko|optiodom_diffdrive/ivanjko/231220200057/231220200057_run-01.csv|--noise-m 0.005"
  "maebot|lcm_maebot_logs/rob550_convex.log|"
)
is_wanted() {
  ((${#wanted[@]})) || return 0
  local name
  for name in "${wanted[@]}"; do [[ $name != "$1" ]] || return 0; done
  return 1
}
names=()
inputs=()
options=()
kinds=()
for recording in "${recordings[@]}"; do
  IFS='|' read -r name input flags <<<"$recording"
  input=$data/$input
  if is_wanted "$name" && [[ -e $input ]]; then
    names+=("$name") inputs+=("$input") options+=("$flags") kinds+=(import)
  fi
done
use_samples=0
if ((${#names[@]} == 0 || ${#wanted[@]})); then
  for input in "$root"/logs/samples/*.log "$root"/logs/samples/*.lcm; do
    [[ -e $input ]] || continue
    name=$(basename "${input%.*}")
    if ((${#wanted[@]} == 0)) || is_wanted "$name"; then
      names+=("$name") inputs+=("$input") options+=("") kinds+=(sample)
      use_samples=1
    fi
  done
fi
for name in "${wanted[@]+"${wanted[@]}"}"; do
  [[ " ${names[*]-} " == *" $name "* ]] ||
    refuse "no recording '$name' in $data, nor in $root/logs/samples"
done
((${#names[@]})) || refuse "nothing to play in $data, nor in logs/samples"

# ---- a network, a folder ---------------------------------------------------

session_out=$out
session_enter_network "$inside" "${BASH_SOURCE[0]}" \
  "${arguments[@]+"${arguments[@]}"}"
url=$(session_url)
session_begin

# ---- play ------------------------------------------------------------------

# play NAME INPUT: real LCM from the player to the recorded log.
play() {
  local name=$1 input=$2
  local folder=$out/processes/$name
  rm -rf "$folder" "$out/$name.lcm"
  mkdir -p "$folder"
  # Stopped from the last to the first: the recorder hears the others' end. It
  # goes first for the processor where that is allowed, since LCM keeps only 30
  # messages for it.
  cat >"$folder/list" <<LIST
lcm_logger: nice -n -10 lcm-logger --quiet --force --lcm-url='$url' '$out/$name.lcm'
pose_filter: '$bin/pose_filter' --lcm-url '$url'
batch_refiner: '$bin/batch_refiner' --lcm-url '$url'
LIST
  session_launch "$folder"
  session_ready "$folder" "$url" "$out/$name.lcm" pose_filter batch_refiner ||
    return 1
  lcm-logplayer --lcm-url="$url" --speed="$speed" "$input" \
    </dev/null >"$folder/lcm_logplayer.txt" 2>&1 9>&- &
  player_pid=$!
  wait "$player_pid" || { session_blame "$folder"; return 1; }
  player_pid=0
  "$bin/waymark-wait" idle --for 0.7 --timeout 30 --lcm-url "$url" || true
  session_end "$folder"
}

if ((use_samples && ${#wanted[@]} == 0)); then
  say "demo: no recordings in $data: playing simulated ones, logs/samples"
fi
mkdir -p "$out/in"
begin=$SECONDS
recorded=()
for i in "${!names[@]}"; do
  name=${names[i]}
  input=${inputs[i]}
  if [[ ${kinds[i]} == import ]]; then
    input=$out/in/$name.lcm
    read -ra flags <<<"${options[i]}"
    "$bin/waymark-log" import --force "${flags[@]+"${flags[@]}"}" \
      "${inputs[i]}" "$input" \
      >"$out/in/$name.txt" 2>&1 || { cat "$out/in/$name.txt" >&2; exit 1; }
  fi
  say "demo: [$((i + 1))/${#names[@]}] $name: playing ${inputs[i]#"$data"/} at $speed times its speed"
  play "$name" "$input" || { say "demo: $name failed; see $out/processes/$name" >&2; exit 1; }
  recorded+=("$out/$name.lcm")
done

# ---- show ------------------------------------------------------------------

say "demo: played in $((SECONDS - begin)) s; evaluating"
say ""
"$bin/waymark-log" report "${recorded[@]}" --out "$out/report.html" \
  --json "$out/report.json" --force
say ""
say "report:  $out/report.html   (details: ./run waymark-log evaluate LOG)"
say "logs:    $out/*.lcm"
