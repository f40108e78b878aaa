#!/usr/bin/env bash
# A simulated robot in a simulated building, live over LCM, driven along
# way-points or by keyboard. Started by ./run demo drive, which builds first.
set -euo pipefail

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)
bin=${WAYMARK_BUILD:-$root/build}/bin
out=$root/out/demo
session_name="demo drive"
source "$root/procman/session.sh"
world=office_u
route=
camera=perspective
keyboard=0
inside=0

usage() {
  cat <<TEXT
usage: ./run demo drive [--world NAME] [--route NAME] [--keyboard]
                        [--camera NAME] [--out FOLDER]

A simulated robot in a simulated building, live over LCM: camera, wheels,
sonar, collision guard, pose filter, recorder. It drives along way-points on
what its pose filter believes, then what happened is evaluated:
FOLDER/drive.html shows errors, pictures and the plan with what it drove and
what it believed (FOLDER/drive.png too), FOLDER/drive.lcm is the recording.

  --world NAME   world, by name or file ($world); waymark-world knows them
  --route NAME   one of the world's routes, to its end and back (its first)
  --keyboard     drive it yourself, in this terminal
  --camera NAME  perspective, fisheye, mirror, panorama or a file ($camera)
  --out FOLDER   where everything goes (out/demo)
TEXT
}

arguments=("$@")
while (($#)); do
  case $1 in
    -h | --help) usage; exit 0 ;;
    --world | --route | --camera | --out)
      [[ -n ${2-} ]] || refuse "$1 needs a value"
      case $1 in
        --world) world=$2 ;;
        --route) route=$2 ;;
        --camera) camera=$2 ;;
        --out) out=$(realpath -m "$2") ;;
      esac
      shift
      ;;
    --keyboard) keyboard=1 ;;
    --inside) inside=1 ;; # In the network namespace that session.sh made.
    *) refuse "unknown argument '$1' (see --help)" ;;
  esac
  shift
done
((!keyboard)) || [[ -t 0 ]] || refuse "--keyboard needs a terminal"
((!keyboard)) || [[ -z $route ]] ||
  refuse "--route is driven without you: leave it or --keyboard out"
# They stand between quotes in the list of processes.
for value in "$world" "$route" "$camera" "$out"; do
  [[ $value != *\'* ]] || refuse "$value: must have no quote in it"
done

# ---- what the world says ---------------------------------------------------

info=$("$bin/waymark-world" info "$world") || exit 2
start=$(awk '$1 == "start" {print $NF; exit}' <<<"$info")
[[ -n $start ]] || refuse "$world has no start for a robot"
IFS=, read -r x y heading <<<"$start"
waypoints=()
if ((!keyboard)); then
  read -ra words < <(awk -v name="$route" \
    '$1 == "route" && (name == "" || $2 == name) {print; exit}' <<<"$info") ||
    refuse "$world has no route ${route:-at all}"
  waypoints=("${words[@]:2}")
  # There and back again.
  for ((i = ${#waypoints[@]} - 2; i >= 0; --i)); do
    waypoints+=("${waypoints[i]}")
  done
fi

# ---- processes -------------------------------------------------------------

session_out=$out
session_enter_network "$inside" "${BASH_SOURCE[0]}" \
  "${arguments[@]+"${arguments[@]}"}"
url=$(session_url)
session_begin
folder=$out/processes/drive
log=$out/drive.lcm
rm -rf "$folder" "$log"
mkdir -p "$folder"
# Stopped from the last to the first: the recorder hears the others' end. The
# filter knows this robot's wheels as well as one knows them after calibration.
cat >"$folder/list" <<LIST
lcm_logger: nice -n -10 lcm-logger --quiet --force --lcm-url='$url' '$log'
pose_filter: '$bin/pose_filter' --lcm-url '$url' --set 'wheels.nominal=[1e-4, 1e-4, 0.27]' --set 'wheels.nominal_sigma=[5e-4, 5e-4, 5e-4]' --set 'noise.wheel_variance=1e-6' --set 'noise.base_variance=1e-8' --set 'start.position=[$x, $y]' --set 'start.heading_deg=$heading'
collision_guard: '$bin/collision_guard' --lcm-url '$url' --set 'stop_file=$folder/stop'
path_follower: '$bin/path_follower' --lcm-url '$url' --set 'task_file=$folder/task'
simulator: '$bin/simulator' --lcm-url '$url' --set 'world=$world' --set 'camera.file=$camera' --set 'state_file=$folder/robot'
LIST
say "demo drive: starting a robot in $world"
session_launch "$folder"
session_ready "$folder" "$url" "$log" pose_filter collision_guard \
  path_follower simulator || exit 1
say "demo drive: watch it, in another terminal: LCM_DEFAULT_URL='$url' ./run spy"

# ---- drive -----------------------------------------------------------------

status=0
if ((keyboard)); then
  # Ctrl-C is the end of the drive, not of the demo.
  trap : INT
  "$bin/teleop" --lcm-url "$url" || status=$?
  session_ends_on INT
else
  "$bin/waymark-task" waypoints "${waypoints[@]}" --follow --lcm-url "$url" ||
    status=$?
fi
session_end "$folder" || status=1
((status == 0)) || say "demo drive: the drive did not end well ($status)" >&2

# ---- show ------------------------------------------------------------------

# What the camera made of its rate beside all the others: by the recording, and
# what the simulator left out because it would have been late.
camera_line() {
  local asked left_out
  asked=$("$bin/simulator" --print-config |
    awk '/^camera:/ {inside = 1} inside && $1 == "rate_hz:" {print $2; exit}')
  left_out=$(sed -n 's/.* IMAGE_FRONT: .* images sent, \([0-9]*\) left out.*/\1/p' \
    "$folder/simulator.txt" | tail -n 1)
  # Counted from the end: the type may be of several words.
  "$bin/waymark-log" info "$log" | awk -v asked="$asked" -v out="$left_out" '
    $1 == "IMAGE_FRONT" {
      printf "camera:  %s Hz of %s asked for, %d images, %s left out, ",
        $(NF - 8), asked, $(NF - 9), out == "" ? "unknown" : out
      printf "longest gap %s s\n", $(NF - 6)
    }'
}

say ""
camera_line
"$bin/waymark-world" plan "$world" --log "$log" --out "$out/drive.png" --force
"$bin/waymark-log" report "$log" --out "$out/drive.html" --force \
  --picture "$out/drive.png" "The plan, with the paths"
say ""
say "report:  $out/drive.html   (errors, plan, pictures)"
say "plan:    $out/drive.png"
say "log:     $log   (./run waymark-log info LOG)"
exit "$status"
