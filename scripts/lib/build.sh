# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
# Building and using what was built; sourced after common.sh.
# shellcheck shell=bash

# Where progress is shown: the terminal also where a script keeps the words of a build in a log.
exec {progress}>&2

# Shows how far ninja is, from its output: on a terminal in one line that is written again and again,
# elsewhere in a line for each tenth.
show_progress() {
  local line shown=0 tenths
  while IFS= read -r line; do
    [[ $line =~ ^\[([0-9]+)/([0-9]+)\]\  ]] || continue
    tenths=$((10 * BASH_REMATCH[1] / BASH_REMATCH[2]))
    if [ -t "$progress" ]; then
      printf '\r   %d of %d ' "${BASH_REMATCH[1]}" "${BASH_REMATCH[2]}" >&"$progress"
    elif [ "$tenths" -gt "$shown" ]; then
      say "  ${BASH_REMATCH[1]} of ${BASH_REMATCH[2]}" 2>&"$progress"
    fi
    shown=$tenths
  done
  [ ! -t "$progress" ] || printf '\r\033[K' >&"$progress"
}

# Configures into directory $1 and builds the targets $2 there; further arguments go to cmake. Quick
# when nothing has changed. Shows how far it is, and the compiler's words only if it fails.
build() {
  local directory=$1 targets
  read -ra targets <<<"$2"
  shift 2
  mkdir -p "$directory"
  say "building in ${directory#"$repository/"}"
  {
    cmake -S "$repository" -B "$directory" -G Ninja \
      -DCMAKE_CXX_COMPILER_LAUNCHER=ccache -DPYTHON_EXECUTABLE="$system_python" "$@" &&
      NINJA_STATUS='[%f/%t] ' cmake --build "$directory" --target "${targets[@]}" --parallel "$(build_jobs)"
  } 2>&1 | tee "$directory/build.log" | show_progress || {
    grep -vE '^(-- |Generating |\[[0-9]+/[0-9]+\] )' "$directory/build.log" |
      tail -n 60 >&2
    die "the build failed, see $directory/build.log"
  }
}

# Builds a target, `all` or what running the driver takes (`cia402_run`); afterwards use_ros makes
# the nodes known to roslaunch and its like. Further arguments go to cmake. Debug information tells
# lines only, and sources are compiled several in one go: most builds of these scripts are made once.
build_ros() {
  local targets=$1
  shift
  build "$build_root/ros" "$targets" -DCMAKE_BUILD_TYPE=RelWithDebInfo \
    '-DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-O2 -g1 -DNDEBUG' -DCIA402_UNITY_BUILD=ON \
    -DCIA402_WITH_ROS=ON -DCIA402_BUILD_BENCHMARKS=ON "$@"
  # rosrun passes over a folder `build` within a package, but looks here.
  ln -sfn build/ros/devel "$repository/devel"
}

# Enters the environment of what build_ros built, with logs kept inside build/ and a master of its
# own: nothing of a ROS system that may run on this machine is touched.
use_ros() {
  set +u  # catkin's scripts read unset variables
  # shellcheck disable=SC1091
  source "$build_root/ros/devel/setup.bash"
  set -u
  export ROS_HOME=$build_root/ros_home
  export ROS_LOG_DIR=$ROS_HOME/log
  export ROS_MASTER_URI
  ROS_MASTER_URI=http://localhost:$(free_port)
  unset ROS_IP ROS_HOSTNAME ROS_NAMESPACE
  export ROS_HOSTNAME=localhost
  # A python of the user's own has no rospy; what asks env for python3 gets the system's.
  export PATH=/usr/bin:/bin:$PATH
}

# A TCP port that is free now.
free_port() {
  "$system_python" -c 'import socket; s = socket.socket(); s.bind(("", 0)); print(s.getsockname()[1])'
}
