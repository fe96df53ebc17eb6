# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
# The two ways to a vcan0; sourced by with_vcan. Both read $timeout (seconds, 0: none).
# shellcheck shell=bash

# What brings the network up, in a namespace as in user-mode Linux.
vcan_up='ip link set lo up && ip link add vcan0 type vcan && ip link set vcan0 up'

# Runs a command in a network namespace that has vcan0. Needs a kernel with vcan.
vcan_in_namespace() {
  local unshare=(unshare --net)
  if [ "$(id -u)" = 0 ]; then
    modprobe vcan 2>/dev/null || true  # may be built in
  else
    unshare+=(--user --map-root-user)
  fi
  # --foreground: Ctrl-C reaches the command.
  timeout --foreground --kill-after=5 "$timeout" \
    "${unshare[@]}" bash -c "($vcan_up) || exit 125; exec \"\$@\"" bash "$@"
}

# Prints the first directory that user-mode Linux can keep its memory in: programs may run from it,
# and it has the space (MB). A tmpfs is fastest.
uml_memory_directory() {
  local megabytes=$1 directory probe
  for directory in /dev/shm "${TMPDIR:-/tmp}" /tmp /var/tmp; do
    [ -w "$directory" ] || continue
    [ "$(df --output=avail -m "$directory" | tail -n 1)" -ge "$megabytes" ] || continue
    probe=$(mktemp "$directory/with_vcan.XXXXXX") || continue
    cp /bin/true "$probe" && chmod +x "$probe"
    if "$probe" 2>/dev/null; then
      rm -f "$probe"
      echo "$directory"
      return
    fi
    rm -f "$probe"
  done
  return 1
}

# Writes what runs as the first process inside user-mode Linux, to $1/init: brings vcan0 up, runs
# the command as it was called here, leaves its exit status in $1/status. No power-off program is
# needed: a bare system has none.
uml_write_init() {
  local directory=$1
  shift
  {
    echo '#!/bin/bash'
    printf 'directory=%q\n' "$directory"
    cat <<'INIT'
export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin
set_up() {
  set -e
  mount -t proc proc /proc
  mount -t sysfs sysfs /sys
  mountpoint -q /dev || mount -t devtmpfs devtmpfs /dev
  mkdir -p /dev/shm /dev/pts
  mount -t tmpfs tmpfs /dev/shm
  mount -t devpts devpts /dev/pts
  ln -sfn /proc/self/fd /dev/fd
  echo localhost > /proc/sys/kernel/hostname
  modules=/usr/lib/uml/modules/$(uname -r)/kernel
  for module in net/can/can net/can/can-raw drivers/net/can/dev/can-dev drivers/net/can/vcan; do
    insmod "$modules/$module.ko"
  done
INIT
    printf '  %s\n}\n' "$vcan_up"
    echo 'run() {'
    export -p
    printf 'cd %q || exit\n' "$PWD"
    printf 'exec'
    printf ' %q' "$@"
    printf '\n}\n'
    cat <<'INIT'
if (set_up) > "$directory/set_up" 2>&1; then
  (run) < /dev/null >> "$directory/stdout" 2>> "$directory/stderr"
  echo $? > "$directory/status"
fi
sync
echo o > /proc/sysrq-trigger
sleep 60
INIT
  } > "$directory/init"
  chmod +x "$directory/init"
}

# Ends user-mode Linux with all its processes; $1 is their process group.
uml_kill() {
  kill -TERM -- "-$1" 2>/dev/null || return 0
  local i
  for i in 1 2 3 4 5 6 7 8 9 10; do
    kill -0 -- "-$1" 2>/dev/null || return 0
    sleep 0.1
  done
  kill -KILL -- "-$1" 2>/dev/null || true
}

# Memory for user-mode Linux in MB: 2 GB, or half of what is free.
uml_megabytes() {
  awk '/^MemAvailable:/ {half = int($2 / 2048); print half < 2048 ? half : 2048}' /proc/meminfo
}

# Runs a command in user-mode Linux, its output live.
vcan_in_uml() {
  command -v linux.uml insmod >/dev/null || {
    echo "with_vcan: this kernel has no vcan, and user-mode Linux is missing:" \
      "run scripts/install_dependencies" >&2
    return 125
  }
  local megabytes memory
  megabytes=$(uml_megabytes)
  memory=$(uml_memory_directory "$megabytes") || {
    echo "with_vcan: none of /dev/shm, ${TMPDIR:-/tmp}, /tmp, /var/tmp has $megabytes MB and lets" \
      "programs run" >&2
    return 125
  }

  # Global, for the traps.
  uml_directory=$(mktemp -d "${TMPDIR:-/tmp}/with_vcan.XXXXXX")
  uml_group=''
  trap '[ -z "$uml_group" ] || uml_kill "$uml_group"; rm -rf "$uml_directory"' EXIT
  trap 'exit 130' INT
  trap 'exit 143' TERM HUP
  touch "$uml_directory/stdout" "$uml_directory/stderr"
  uml_write_init "$uml_directory" "$@"
  local preload=$uml_directory/preload.so
  cc -O2 -Wall -Wextra -shared -fPIC -o "$preload" "$here"/lib/uml_{xstate,time}.c || {
    echo "with_vcan: what user-mode Linux is run with was not compiled, see above" >&2
    return 125
  }

  # timeout makes the process group, so that Ctrl-C reaches this script alone.
  setpriv --pdeathsig TERM timeout --kill-after=2 "$timeout" \
    env "LD_PRELOAD=$preload" "TMPDIR=$memory" \
    linux.uml "mem=${megabytes}M" rootfstype=hostfs rootflags=/ rw "init=$uml_directory/init" \
    "uml_dir=$uml_directory/" umid=uml con=null con0=null,fd:2 \
    </dev/null >"$uml_directory/console" 2>&1 &
  uml_group=$!
  tail -n +1 -s 0.1 -f --pid="$uml_group" "$uml_directory/stdout" &
  local tails=$!
  tail -n +1 -s 0.1 -f --pid="$uml_group" "$uml_directory/stderr" >&2 &
  tails+=" $!"

  local uml_status=0
  wait "$uml_group" || uml_status=$?
  uml_kill "$uml_group"
  # shellcheck disable=SC2086
  wait $tails || true
  uml_result "$uml_status"
}

# The exit status of the command, or what went wrong instead. $1: exit status of user-mode Linux.
uml_result() {
  if [ -s "$uml_directory/status" ]; then
    return "$(cat "$uml_directory/status")"
  elif [ "$1" = 124 ] || [ "$1" = 137 ]; then
    echo "with_vcan: killed after $timeout s" >&2
    return 124
  fi
  {
    echo "with_vcan: user-mode Linux ended (status $1) before the command did; its last words:"
    cat "$uml_directory/set_up" 2>/dev/null || true
    tail -n 25 "$uml_directory/console"
  } >&2
  return 125
}
