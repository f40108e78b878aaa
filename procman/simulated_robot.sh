# What demos with a simulated robot share. Sourced after session.sh by scripts
# that set
#   option  an associative array of their options with a value, by name,
#   flag    the same of those without, 0 or 1;
# both are theirs to read afterwards. `world`, `camera` and `out` are among the
# options.

# robot_options ARGUMENTS...: what the command line says; ends on --help.
inside=0
robot_options() {
  local name
  while (($#)); do
    name=${1#--}
    if [[ $1 == -h || $1 == --help ]]; then
      usage
      exit 0
    elif [[ $1 == --inside ]]; then
      inside=1 # In the network namespace that session.sh made.
    elif [[ ! $1 =~ ^--[a-z]+$ ]]; then
      refuse "unknown argument '$1' (see --help)"
    elif [[ -n ${option[$name]+set} ]]; then
      [[ -n ${2-} ]] || refuse "$1 needs a value"
      option[$name]=$2
      shift
    elif [[ -n ${flag[$name]+set} ]]; then
      flag[$name]=1
    else
      refuse "unknown argument '$1' (see --help)"
    fi
    shift
  done
  option[out]=$(realpath -m "${option[out]}")
  # They stand between quotes in the list of processes.
  local value
  for value in "${option[@]}"; do
    [[ $value != *\'* ]] || refuse "$value: must have no quote in it"
  done
}

# robot_start: world_info, and the start x, y, heading that the world names.
robot_start() {
  world_info=$("$bin/waymark-world" info "${option[world]}") || exit 2
  local start
  start=$(awk '$1 == "start" {print $NF; exit}' <<<"$world_info")
  [[ -n $start ]] || refuse "${option[world]} has no start for a robot"
  IFS=, read -r x y heading <<<"$start"
  "$bin/simulator" --check-config --set "world=${option[world]}" \
    --set "camera.file=${option[camera]}" >/dev/null || exit 2
}

# robot_begin NAME [ARGUMENTS...] of the script: enters a network, makes the
# folder of processes and names the recording, out/NAME.lcm.
robot_begin() {
  local name=$1
  shift
  session_out=${option[out]}
  session_enter_network "$inside" "$@"
  url=$(session_url)
  session_begin
  folder=$session_out/processes/$name
  log=$session_out/$name.lcm
  page=$session_out/$name.html
  plan=$session_out/$name.png
  rm -rf "$folder" "$log"
  mkdir -p "$folder"
}

# robot_list SIMULATOR FILTER [LINE...]: the processes of a robot that drives on
# what its filter believes, for the launcher; further settings of both, further
# processes. Stopped from the last to the first: the recorder hears the others'
# end, and no image is without someone who looks at it.
robot_list() {
  local settings=$1 filter=$2
  shift 2
  cat <<LIST
lcm_logger: nice -n -10 lcm-logger --quiet --force --lcm-url='$url' '$log'
pose_filter: '$bin/pose_filter' --lcm-url '$url' --set 'wheels.nominal=[1e-4, 1e-4, 0.27]' --set 'noise.wheel_variance=1e-6' --set 'noise.base_variance=1e-8' --set 'start.position=[$x, $y]' --set 'start.heading_deg=$heading' $filter
collision_guard: '$bin/collision_guard' --lcm-url '$url' --set 'stop_file=$folder/stop'
path_follower: '$bin/path_follower' --lcm-url '$url' --set 'task_file=$folder/task'
LIST
  (($# == 0)) || printf '%s\n' "$@"
  cat <<LIST
simulator: '$bin/simulator' --lcm-url '$url' --set 'world=${option[world]}' --set 'camera.file=${option[camera]}' --set 'state_file=$folder/robot' $settings
LIST
}

# robot_launch PROCESS...: starts FOLDER/list, and waits for these beside the
# usual ones.
robot_launch() {
  say "$session_name: starting a robot in ${option[world]}"
  session_launch "$folder"
  session_ready "$folder" "$url" "$log" pose_filter collision_guard \
    path_follower simulator "$@" || exit 1
  say "$session_name: watch it, in another terminal:" \
    "LCM_DEFAULT_URL='$url' ./run spy"
}

# robot_end STATUS: stops all; returns how it went.
robot_end() {
  local status=$1
  session_end "$folder" || status=1
  ((status == 0)) ||
    say "$session_name: the drive did not end well ($status)" >&2
  return "$status"
}

# What the camera made of its rate beside all the others: by the recording, and
# what the simulator left out because it would have been late.
robot_camera_line() {
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

# robot_report [ARGUMENTS OF waymark-log report...]: plan and page.
robot_report() {
  "$bin/waymark-world" plan "${option[world]}" --log "$log" --out "$plan" --force
  "$bin/waymark-log" report "$log" --out "$page" --force \
    --picture "$plan" "The plan, with the paths" "$@"
}

robot_files() {
  say ""
  say "report:  $page   (errors, plan, pictures)"
  say "plan:    $plan"
  say "log:     $log   (./run waymark-log info LOG)"
}
