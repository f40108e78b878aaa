#!/usr/bin/env bash
# A simulated robot that drives in a corridor on what its camera sees of the
# corridor's lines, live over LCM. Started by ./run demo corridor, which builds
# first.
set -euo pipefail

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)
bin=${WAYMARK_BUILD:-$root/build}/bin
session_name="demo corridor"
source "$root/procman/session.sh"
source "$root/procman/simulated_robot.sh"
declare -A option=([task]=turns [length]=10 [world]=corridor_plain [corridors]=
  [corridor]= [camera]=perspective [out]=$root/out/demo)
declare -A flag=([full]=0)

usage() {
  cat <<TEXT
usage: ./run demo corridor [--task NAME] [--full] [--length M] [--world NAME]
                           [--corridors NAME] [--corridor NAME]
                           [--camera NAME] [--out FOLDER]

A simulated robot drives in a corridor, live over LCM: camera, wheels, sonar,
corridor tracker, pose filter, recorder. It knows its wheels to 0.4 % and the
corridor's size; where it is across the corridor, and which way it looks, it
sees by the lines of its images. Then what happened is evaluated:
FOLDER/corridor.html shows errors, the lines in the images and the plan,
FOLDER/corridor.lcm is the recording.

  --task NAME       turns: there and back (turns)
                    zigzag: the same, 40 cm to either side all the way
                    blind: straight on for 14 m, 6 m with the lens covered
                    learn: a zig-zag of 16 m with wheels that it believes to be
                    others: 11 % between right and left, 18.5 % of their base
  --full            as often as published: twice there and back; 12 m blind;
                    2,500 images to learn from
  --length M        of each way, of turns and zigzag, from 2 m behind the
                    corridor's beginning on (10)
  --world NAME      corridor_plain, corridor_office (furnished, with people) or
                    another that has a corridor (corridor_plain)
  --corridors NAME  where the corridors are: file or name (the world's name)
  --corridor NAME   the one to drive in, of several; the robot starts where the
                    world says, which must be in it (the one with the start)
  --camera NAME     perspective, fisheye, mirror or a file (perspective)
  --out FOLDER      where everything goes (out/demo)
TEXT
}

robot_options "$@"
full=${flag[full]}
corridors=${option[corridors]:-${option[world]}}
settings=
wheels="--set 'wheels.nominal_sigma=[4e-3, 4e-3, 4e-3]'"
way=(--begin 2 --length "${option[length]}" --legs $((full ? 4 : 2)))
case ${option[task]} in
  turns) ;;
  zigzag) way+=(--zigzag 0.4 --zigzag-step 2) ;;
  blind)
    # Of the way driven. It sees before, for as long as it takes to learn its
    # wheels a little, and behind.
    way=(--begin 2 --length $((full ? 15 : 14)) --legs 1)
    settings="--set 'camera.covered_way_m=[$((full ? 2 : 4)), $((full ? 14 : 10))]'"
    ;;
  learn)
    way=(--begin 2 --length 16 --legs $((full ? 3 : 1)) --zigzag 0.4 --zigzag-step 2)
    wheels="--set 'wheels.nominal=[1.05409e-4, 0.94868e-4, 0.22]' --set 'wheels.nominal_sigma=[0.2, 0.2, 0.2]'"
    ;;
  *) refuse "--task: '${option[task]}' is none of turns, zigzag, blind, learn" ;;
esac
[[ -z ${option[corridor]} ]] || way+=(--corridor "${option[corridor]}")
case ${option[task]} in
  blind | learn)
    [[ " $* " != *" --length "* ]] ||
      refuse "--length: not of the task ${option[task]}, whose way is given" ;;
esac
robot_start
"$bin/corridor_tracker" --check-config --set "corridors=$corridors" >/dev/null ||
  exit 2

way+=(--start "$x,$y")
"$bin/waymark-task" corridor "$corridors" "${way[@]}" --check || exit 2

# ---- processes -------------------------------------------------------------

robot_begin corridor "${BASH_SOURCE[0]}" "$@"
# Lines need no colour: 15 gray images a second leave a machine with two cores
# time for all the others.
settings+=" --set 'camera.gray=true'"
# Wheels that differ from the nominal ones by what tyres do between two
# calibrations; the filter allows for twice as much.
settings+=" --set 'noise.right_wheel_factor=1.002' --set 'noise.left_wheel_factor=0.998' --set 'noise.wheel_base_factor=1.002'"
robot_list "$settings" "$wheels" \
  "corridor_tracker: '$bin/corridor_tracker' --lcm-url '$url' --set 'corridors=$corridors'" \
  >"$folder/list"
robot_launch corridor_tracker

# ---- drive -----------------------------------------------------------------

status=0
"$bin/waymark-task" corridor "$corridors" "${way[@]}" --follow \
  --lcm-url "$url" || status=$?
robot_end "$status" || status=$?

# ---- show ------------------------------------------------------------------

say ""
robot_camera_line
robot_report
if [[ ${option[task]} == learn ]]; then
  say ""
  say "wheels, as believed (nominal), learned (online) and simulated (truth):"
  "$bin/waymark-log" evaluate "$log" | grep -A 3 "parameters  "
fi
robot_files
exit "$status"
