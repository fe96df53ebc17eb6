# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
# Other Debians to build and test in; sourced by test_platforms after common.sh.
# shellcheck shell=bash

platforms=$build_root/platforms
mirror=${DEBIAN_MIRROR:-http://deb.debian.org/debian}
# Where qemu needs longer than this for one program, something hangs.
test_timeout=3600
# They ask the kernel about the memory of their process: under qemu it is the emulator's.
not_emulated=SimulatedRunner.ThreadOfTheBusHasNoPageFaultOnceItRuns:MemoryPages.*

# Of platform $1: Debian's name of the system, and the processor that is compiled for.
suite_of() { if [ "$1" = debian11 ]; then echo bullseye; else echo bookworm; fi; }
processor_of() { if [ "$1" = debian11 ]; then dpkg --print-architecture; else echo "$1"; fi; }

# What platform $1 needs beyond a minimal system.
packages_of() {
  case "$1" in
    debian11)
      # ROS as scripts/install_dependencies has it, as far as it concerns building.
      echo g++-9 make ninja-build cmake ccache
      "$here/install_dependencies" --list |
        grep -E '^(lib.*-dev|catkin|ros-.*|python3-(std|sensor|geometry|trajectory|diagnostic|actionlib|tf2)-.*msgs)$'
      ;;
    *)
      echo "g++-$(triplet_of "$1")" ninja-build cmake ccache qemu-user-static \
        {libeigen3-dev,libyaml-cpp-dev,libgtest-dev,libgmock-dev,libstdc++6}":$1" ;;
  esac
}

# What Debian calls the compiler of a processor.
triplet_of() { if [ "$1" = arm64 ]; then echo aarch64-linux-gnu; else echo arm-linux-gnueabihf; fi; }
qemu_of() { if [ "$1" = arm64 ]; then echo qemu-aarch64-static; else echo qemu-arm-static; fi; }

# Runs a command in the Debian of platform $1. It sees the repository as /repository, which it cannot
# change, and the build of the platform as /build. Mounts end with the command.
inside() {
  local root=$platforms/$1/root build=$platforms/$1/build
  shift
  mkdir -p "$root/repository" "$root/build" "$build" "$platforms/ccache" "$root/ccache"
  unshare --mount --pid --fork --kill-child -- bash -c '
    root=$1 repository=$2 build=$3 ccache=$4
    shift 4
    mount --bind "$repository" "$root/repository" && mount -o remount,ro,bind "$root/repository"
    mount --bind "$build" "$root/build" && mount --bind "$ccache" "$root/ccache"
    mount -t proc proc "$root/proc" && mount --bind /dev "$root/dev"
    exec chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 \
      DEBIAN_FRONTEND=noninteractive CCACHE_DIR=/ccache CCACHE_BASEDIR=/ "$@"' \
    bash "$root" "$repository" "$build" "$platforms/ccache" "$@"
}

# Makes the Debian of platform $1 unless it is there.
install_platform() {
  local name=$1 root=$platforms/$1/root packages
  [ ! -e "$platforms/$name/installed" ] || return 0
  mapfile -t packages < <(packages_of "$name" | tr ' ' '\n')
  rm -rf "$root"
  mkdir -p "$root" &&
    install_debootstrap &&
    debootstrap --variant=minbase "$(suite_of "$name")" "$root" "$mirror" &&
    cp /etc/resolv.conf "$root/etc/" &&
    { [ "$name" = debian11 ] || inside "$name" dpkg --add-architecture "$name"; } &&
    inside "$name" apt-get -q update &&
    inside "$name" apt-get -q install -y --no-install-recommends "${packages[@]}" &&
    touch "$platforms/$name/installed"
}

install_debootstrap() {
  command -v debootstrap >/dev/null ||
    DEBIAN_FRONTEND=noninteractive apt-get -q install -y --no-install-recommends debootstrap
}

# What CMake is told on platform $1.
cmake_arguments() {
  local triplet
  case "$1" in
    debian11)
      echo -DCMAKE_CXX_COMPILER=g++-9 -DCIA402_WITH_ROS=ON -DPYTHON_EXECUTABLE=/usr/bin/python3 ;;
    *)
      triplet=$(triplet_of "$1")
      echo -DCMAKE_SYSTEM_NAME=Linux "-DCMAKE_SYSTEM_PROCESSOR=$1" \
        "-DCMAKE_CXX_COMPILER=$triplet-g++" "-DCMAKE_LIBRARY_ARCHITECTURE=$triplet" \
        "-DCMAKE_PREFIX_PATH=/usr/lib/$triplet" -DCIA402_WITH_ROS=OFF ;;
  esac
}

build_platform() {
  local arguments targets=(cia402_tests)
  read -ra arguments <<<"$(cmake_arguments "$1")"
  [ "$1" != debian11 ] || targets+=(cia402_run)
  inside "$1" cmake -S /repository -B /build -G Ninja -DCMAKE_CXX_COMPILER_LAUNCHER=ccache \
    -DCMAKE_BUILD_TYPE=RelWithDebInfo "-DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-O2 -g1 -DNDEBUG" \
    -DCIA402_UNITY_BUILD=ON "${arguments[@]}" &&
    inside "$1" cmake --build /build --target "${targets[@]}" --parallel "$(build_jobs)"
}

# Runs the test executables of platform $1; a line each in its results.
run_platform_tests() {
  local name=$1 emulator='' filter='*' program outcome
  [ "$name" = debian11 ] || emulator=$(qemu_of "$name") filter="-$not_emulated"
  while read -r program; do
    [[ $program != *_vcan ]] || continue  # needs an interface of the kernel
    outcome=passed
    # shellcheck disable=SC2086
    inside "$name" timeout "$test_timeout" $emulator "$program" --gtest_brief=1 \
      --gtest_filter="$filter" \
      >"$platforms/$name/$(basename "$program").log" 2>&1 </dev/null || outcome=failed
    printf '%s\t%s\n' "$outcome" "$(basename "$program")" >>"$platforms/$name/results.tsv"
    say "$name: $(basename "$program") $outcome"
  done <"$platforms/$name/build/tests.txt"
}

test_platform() {
  local name=$1
  mkdir -p "$platforms/$name"
  : >"$platforms/$name/results.tsv"
  say "$name: system"
  if ! install_platform "$name" >"$platforms/$name/install.log" 2>&1; then
    printf 'failed\tinstallation (install.log)\n' >>"$platforms/$name/results.tsv"
    return
  fi
  say "$name: build"
  if ! build_platform "$name" >"$platforms/$name/build.log" 2>&1; then
    printf 'failed\tbuild (build.log)\n' >>"$platforms/$name/results.tsv"
    return
  fi
  printf 'passed\tbuild\n' >>"$platforms/$name/results.tsv"
  run_platform_tests "$name"
}

# What was compiled with on platform $1, in words.
tools_of() {
  local compiler
  compiler=$(sed -n 's/^CMAKE_CXX_COMPILER:[^=]*=//p' "$platforms/$1/build/CMakeCache.txt" 2>/dev/null) || true
  [ -n "$compiler" ] || return 0
  printf '%s %s, %s' "$(basename "$compiler")" "$(inside "$1" "$compiler" -dumpfullversion)" \
    "$(inside "$1" cmake --version | sed -n '1s/ version//p')"
}

# A line for each platform, what failed, and the closing line. Exit status 1 on any failure.
summary_of() {
  local name results passed=0 failed=0 here_passed here_failed
  for name in "$@"; do
    results=$platforms/$name/results.tsv
    here_passed=$(grep -c ^passed "$results" || true)
    here_failed=$(grep -c ^failed "$results" || true)
    echo "$name ($(tools_of "$name")): $here_passed passed, $here_failed failed"
    sed -n "s/^failed\t/  FAILED /p" "$results"
    passed=$((passed + here_passed)) failed=$((failed + here_failed))
  done
  echo "$passed passed, $failed failed"
  [ "$failed" = 0 ] && [ "$passed" -gt 0 ]
}
