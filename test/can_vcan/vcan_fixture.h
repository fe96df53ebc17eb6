// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// For tests of SocketCan on a real kernel interface, to be run by scripts/with_vcan only: they take
// vcan0 down, remove it and add it again.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "can/socketcan.h"

namespace cia402::can {

using std::chrono::milliseconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// The wire is the machine's own memory, but the machine may have much else to do.
inline constexpr milliseconds kPatience{10'000};
inline constexpr milliseconds kQuiet{30};

inline Time now() {
  timespec time{};
  ::clock_gettime(CLOCK_MONOTONIC, &time);
  return Time(std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec));
}

inline bool run(const std::string& command) {
  return std::system((command + " >/dev/null 2>&1").c_str()) == 0;
}

inline std::optional<ReceivedFrame> receiveWithin(SocketCan& can, milliseconds patience) {
  const Time deadline = now() + patience;
  for (;;) {
    can.maintain(now());
    if (auto received = can.receive(now())) return received;
    const Time time = now();
    if (time >= deadline) return std::nullopt;
    pollfd descriptor{can.fd(), POLLIN, 0};
    const auto left = std::chrono::duration_cast<milliseconds>(deadline - time).count();
    ::poll(&descriptor, can.fd() >= 0 ? 1 : 0, static_cast<int>(left < 10 ? left + 1 : 10));
  }
}

inline std::vector<std::uint32_t> receivedIds(SocketCan& can, milliseconds patience = kQuiet) {
  std::vector<std::uint32_t> ids;
  while (const auto received = receiveWithin(can, patience)) ids.push_back(received->frame.id);
  return ids;
}

inline bool becomes(SocketCan& can, BusState state) {
  const Time deadline = now() + kPatience;
  while (now() < deadline) {
    can.maintain(now());
    can.receive(now());
    if (can.state() == state) return true;
    std::this_thread::sleep_for(milliseconds(2));
  }
  return false;
}

// The state may be known before the kernel lets frames out again.
inline bool takes(SocketCan& can, const Frame& frame) {
  for (const Time deadline = now() + kPatience; now() < deadline;) {
    can.maintain(now());
    if (can.send(frame)) return true;
    std::this_thread::sleep_for(milliseconds(2));
  }
  return false;
}

// A socket without any of SocketCan in it: sends error frames as a controller's driver would, and
// shows what other programs on the machine see.
class PlainSocket {
 public:
  PlainSocket() : fd_(::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW)) {
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(::if_nametoindex("vcan0"));
    bound_ = ::bind(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  }
  ~PlainSocket() { ::close(fd_); }
  PlainSocket(const PlainSocket&) = delete;
  PlainSocket& operator=(const PlainSocket&) = delete;

  bool send(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) {
    can_frame frame{};
    frame.can_id = id;
    for (std::uint8_t byte : bytes) frame.data[frame.can_dlc++] = byte;
    return bound_ && ::write(fd_, &frame, sizeof frame) == sizeof frame;
  }
  // can_id as the kernel gives it, 0 if there is none.
  std::uint32_t receivedId() {
    can_frame frame{};
    pollfd descriptor{fd_, POLLIN, 0};
    if (::poll(&descriptor, 1, static_cast<int>(kPatience.count())) != 1) return 0;
    return ::read(fd_, &frame, sizeof frame) == sizeof frame ? frame.can_id : 0;
  }

 private:
  int fd_;
  bool bound_ = false;
};

inline bool onUserModeLinux() {
  std::ifstream info("/proc/cpuinfo");
  const std::string text{std::istreambuf_iterator<char>(info), {}};
  return text.find("User Mode Linux") != std::string::npos;
}

class SocketCanOnVcan : public ::testing::Test {
 protected:
  void SetUp() override {
    run("ip link add dev vcan0 type vcan");
    run("tc qdisc del dev vcan0 root");
    ASSERT_TRUE(run("ip link set vcan0 up")) << "no vcan0: run this by scripts/with_vcan";
  }
  void TearDown() override {
    run("ip link add dev vcan0 type vcan");
    run("tc qdisc del dev vcan0 root");
    run("ip link set vcan0 up");
  }
  static SocketCan::Options options() {
    SocketCan::Options options;
    options.check_period = milliseconds(20);
    return options;
  }
};

}  // namespace cia402::can
