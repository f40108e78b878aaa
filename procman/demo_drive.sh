#!/usr/bin/env bash
# A simulated robot in a simulated building, live over LCM, driven along
# way-points or by keyboard. Started by ./run demo drive, which builds first.
set -euo pipefail

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)
bin=${WAYMARK_BUILD:-$root/build}/bin
session_name="demo drive"
source "$root/procman/session.sh"
source "$root/procman/simulated_robot.sh"
declare -A option=([world]=office_u [route]= [camera]=perspective
  [out]=$root/out/demo)
declare -A flag=([keyboard]=0)

usage() {
  cat <<TEXT
usage: ./run demo drive [--world NAME] [--route NAME] [--keyboard]
                        [--camera NAME] [--out FOLDER]

A simulated robot in a simulated building, live over LCM: camera, wheels,
sonar, collision guard, pose filter, recorder. It drives along way-points on
what its pose filter believes, then what happened is evaluated:
FOLDER/drive.html shows errors, pictures and the plan with what it drove and
what it believed (FOLDER/drive.png too), FOLDER/drive.lcm is the recording.

  --world NAME   world, by name or file (office_u); waymark-world knows them
  --route NAME   one of the world's routes, to its end and back (its first)
  --keyboard     drive it yourself, in this terminal
  --camera NAME  perspective, fisheye, mirror, panorama or a file (perspective)
  --out FOLDER   where everything goes (out/demo)
TEXT
}

robot_options "$@"
keyboard=${flag[keyboard]}
((!keyboard)) || [[ -t 0 ]] || refuse "--keyboard needs a terminal"
((!keyboard)) || [[ -z ${option[route]} ]] ||
  refuse "--route is driven without you: leave it or --keyboard out"

# ---- what the world says ---------------------------------------------------

robot_start
waypoints=()
if ((!keyboard)); then
  read -ra words < <(awk -v name="${option[route]}" \
    '$1 == "route" && (name == "" || $2 == name) {print; exit}' \
    <<<"$world_info") ||
    refuse "${option[world]} has no route ${option[route]:-at all}"
  waypoints=("${words[@]:2}")
  # There and back again.
  for ((i = ${#waypoints[@]} - 2; i >= 0; --i)); do
    waypoints+=("${waypoints[i]}")
  done
fi

# ---- processes -------------------------------------------------------------

robot_begin drive "${BASH_SOURCE[0]}" "$@"
# The filter knows this robot's wheels as well as one knows them after
# calibration.
robot_list "" "--set 'wheels.nominal_sigma=[5e-4, 5e-4, 5e-4]'" >"$folder/list"
robot_launch

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
robot_end "$status" || status=$?

# ---- show ------------------------------------------------------------------

say ""
robot_camera_line
robot_report
robot_files
exit "$status"
