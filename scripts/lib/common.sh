# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
# Shared by the scripts in scripts/; sourced, never run.
# shellcheck shell=bash

repository=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd -P)
build_root=$repository/build
# ROS of Debian is built for this one; another python3 may come first in PATH.
system_python=/usr/bin/python3

# A heading on the terminal with the minutes since the start, so that a long run can be followed.
say() { printf '== %2d:%02d %s\n' $((SECONDS / 60)) $((SECONDS % 60)) "$*" >&2; }

# Ends the script with a sentence.
die() {
  printf '%s: %s\n' "$(basename "$0")" "$*" >&2
  exit 1
}

# Prints the comment block at the head of the calling script, from its third line on, as its help.
show_help() { sed -n '4,/^$/{/^#/s/^# \{0,1\}//p}' "$0"; }

# Runs a command as root, by sudo where needed.
as_root() {
  if [ "$(id -u)" = 0 ]; then
    "$@"
  elif command -v sudo >/dev/null; then
    sudo "$@"
  else
    die "'$*' needs root; run as root or install sudo"
  fi
}

# How many jobs to build with: one per processor, but no more than memory allows (2 GB each).
build_jobs() {
  local processors memory_kb
  processors=$(nproc)
  memory_kb=$(awk '/^MemAvailable:/ {print $2}' /proc/meminfo)
  local by_memory=$((memory_kb / 2000000))
  [ "$by_memory" -ge 1 ] || by_memory=1
  echo $((processors < by_memory ? processors : by_memory))
}
