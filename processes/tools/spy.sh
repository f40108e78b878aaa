#!/usr/bin/env bash
# lcm-spy with Waymark's types and image viewer, on Java 17 (Debian's own start
# script passes a flag that Java 17 refuses).
set -euo pipefail

refuse() { printf 'waymark-spy: %s\n' "$*" >&2; exit 2; }

usage() {
  cat <<'TEXT'
usage: waymark-spy [--lcm-url URL]

Shows all LCM channels: type, rate, loss of decoding, every field. A double
click on a channel shows its fields, or its images where it carries images
(GRAY, RGB, BGR, MJPEG); a right click offers both.

  --lcm-url URL  default: LCM_DEFAULT_URL, else udpm://239.255.76.67:7667?ttl=0
  --help         this text

CLASSPATH may name further jars with types and plugins of your own, separated
by colons. WAYMARK_SPY_HEAP is the Java heap (default 512m).
lcm-spy cannot ask for a larger receive buffer. If raw images show a lower
rate than their sender's, raise the default of the machine:
  sudo sysctl -w net.core.rmem_max=4194304 net.core.rmem_default=4194304
TEXT
}

url=${LCM_DEFAULT_URL:-udpm://239.255.76.67:7667?ttl=0}
while (($#)); do
  case $1 in
    -h | --help) usage; exit 0 ;;
    -l | --lcm-url)
      (($# > 1)) || refuse "$1 needs a URL"
      url=$2
      shift
      ;;
    --lcm-url=*) url=${1#*=} ;;
    *) refuse "unknown argument '$1'; --help lists all" ;;
  esac
  shift
done

# Installed, this file is <prefix>/bin/waymark-spy; else it lies in the source.
here=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")" && pwd)
jars=
for folder in "$here/../share/java" "$here/../../build/share/java"; do
  [[ ! -f $folder/lcmtypes_waymark.jar ]] || { jars=$folder; break; }
done
[[ -n $jars ]] ||
  refuse "no lcmtypes_waymark.jar near $here; build it first: ./run build"

command -v java >/dev/null ||
  refuse "no java; install the package openjdk-17-jre"
for pair in lcm:liblcm-java jchart2d:libjchart2d-java; do
  [[ -f /usr/share/java/${pair%:*}.jar ]] ||
    refuse "no /usr/share/java/${pair%:*}.jar; install the package ${pair#*:}"
done
java_lib=$(dirname "$(readlink -f "$(command -v java)")")/../lib
[[ -f $java_lib/libawt_xawt.so ]] ||
  refuse "this java has no windows (headless); install openjdk-17-jre"
[[ -n ${DISPLAY:-} ]] ||
  refuse "no display: DISPLAY is not set; lcm-spy opens a window (ssh -X)"

# The class path alone is searched: a CLASSPATH left in the environment would
# be searched a second time and offer each plugin twice.
path=/usr/share/java/lcm.jar:/usr/share/java/jchart2d.jar
path+=:$jars/lcmtypes_waymark.jar:$jars/lcmspy_plugins_waymark.jar
path+=${CLASSPATH:+:$CLASSPATH}
unset CLASSPATH
# Viewers open a bus of their own by the environment, hence not by lcm-spy -l.
export LCM_DEFAULT_URL=$url
exec java -Djava.net.preferIPv4Stack=true -Xmx"${WAYMARK_SPY_HEAP:-512m}" \
  -cp "$path" lcm.spy.Spy
