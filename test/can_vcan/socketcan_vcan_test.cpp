// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// SocketCan on a real kernel interface. To be run by scripts/with_vcan only: takes vcan0 down,
// removes it and adds it again.
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

#include "cia402_driver/can/socketcan.h"

namespace cia402::can {
namespace {

using std::chrono::milliseconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// The wire is the machine's own memory, but user-mode Linux may be late by some milliseconds.
constexpr milliseconds kPatience{500};
constexpr milliseconds kQuiet{30};

Time now() {
  timespec time{};
  ::clock_gettime(CLOCK_MONOTONIC, &time);
  return Time(std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec));
}

bool run(const std::string& command) {
  return std::system((command + " >/dev/null 2>&1").c_str()) == 0;
}

std::optional<ReceivedFrame> receiveWithin(SocketCan& can, milliseconds patience) {
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

std::vector<std::uint32_t> receivedIds(SocketCan& can, milliseconds patience = kQuiet) {
  std::vector<std::uint32_t> ids;
  while (const auto received = receiveWithin(can, patience)) ids.push_back(received->frame.id);
  return ids;
}

bool becomes(SocketCan& can, BusState state) {
  const Time deadline = now() + kPatience;
  while (now() < deadline) {
    can.maintain(now());
    can.receive(now());
    if (can.state() == state) return true;
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

TEST_F(SocketCanOnVcan, CarriesEveryKindOfFrameToTheOtherSocketsButNotToItself) {
  SocketCan a("vcan0");
  SocketCan b("vcan0");
  PlainSocket other_program;
  ASSERT_EQ(a.state(), BusState::error_active) << a.describe();
  Frame extended(0x1ABCDEF0, {1, 2, 3, 4, 5, 6, 7, 8});
  extended.extended = true;
  Frame remote(0x701, {});
  remote.remote = true;
  remote.size = 1;
  for (const Frame& frame : {Frame(0x000, {0x01, 0x00}), Frame(0x7FF, {}), extended, remote}) {
    ASSERT_TRUE(a.send(frame));
    const auto received = receiveWithin(b, kPatience);
    ASSERT_TRUE(received);
    EXPECT_EQ(received->frame, frame);
  }
  EXPECT_FALSE(receiveWithin(a, kQuiet));
  EXPECT_EQ(other_program.receivedId(), 0x000u);
  EXPECT_EQ(other_program.receivedId(), 0x7FFu);
  EXPECT_EQ(other_program.receivedId(), 0x9ABCDEF0u);  // CAN_EFF_FLAG
  EXPECT_EQ(other_program.receivedId(), 0x40000701u);  // CAN_RTR_FLAG
  EXPECT_EQ(a.counters().frames_sent, 4u);
  EXPECT_EQ(a.counters().frames_received, 0u);
  EXPECT_EQ(b.counters().frames_received, 4u);
  EXPECT_EQ(a.counters().frames_dropped, 0u);
}

TEST_F(SocketCanOnVcan, ReceivesMoreFramesThanOneBatchInOrder) {
  SocketCan a("vcan0");
  SocketCan b("vcan0");
  for (std::uint32_t i = 0; i < 100; ++i) ASSERT_TRUE(a.send(Frame(i, {})));
  const auto ids = receivedIds(b);
  ASSERT_EQ(ids.size(), 100u);
  for (std::uint32_t i = 0; i < 100; ++i) EXPECT_EQ(ids[i], i);
}

TEST_F(SocketCanOnVcan, FiltersInTheKernel) {
  SocketCan::Options options = this->options();
  options.filters = {{0x180, 0x780, false}, {0x701, 0x7FF, false}, {0x181, 0x1FFFFFFF, true}};
  SocketCan filtered("vcan0", options);
  SocketCan sender("vcan0");
  const auto sendAll = [&] {
    for (std::uint32_t id : {0x080U, 0x181U, 0x1FFU, 0x200U, 0x701U, 0x702U}) {
      sender.send(Frame(id, {}));
    }
    Frame extended(0x181, {0xEE});
    extended.extended = true;
    sender.send(extended);
    extended.id = 0x701;
    sender.send(extended);
  };
  sendAll();
  EXPECT_THAT(receivedIds(filtered), ElementsAre(0x181, 0x1FF, 0x701, 0x181));
  filtered.setFilters({{0x080, 0x7FF, false}});
  sendAll();
  EXPECT_THAT(receivedIds(filtered), ElementsAre(0x080));
  filtered.setFilters({});
  sendAll();
  EXPECT_EQ(receivedIds(filtered).size(), 8u);
}

bool onUserModeLinux() {
  std::ifstream info("/proc/cpuinfo");
  const std::string text{std::istreambuf_iterator<char>(info), {}};
  return text.find("User Mode Linux") != std::string::npos;
}

void expectStampBetweenSendAndReceive(SocketCan& sender, SocketCan& receiver) {
  const Time before = now();
  ASSERT_TRUE(sender.send(Frame(0x080, {})));
  const auto received = receiveWithin(receiver, kPatience);
  const Time after = now();
  ASSERT_TRUE(received);
  // The two clocks are compared by software: a millisecond is for user-mode Linux.
  EXPECT_GE(received->stamp, before - milliseconds(1));
  EXPECT_LE(received->stamp, after);
}

TEST_F(SocketCanOnVcan, StampsOnTheMonotonicClock) {
  SocketCan a("vcan0");
  SocketCan b("vcan0");
  for (int i = 0; i < 20; ++i) expectStampBetweenSendAndReceive(a, b);
}

TEST_F(SocketCanOnVcan, StampsWhenAFrameCameNotWhenItWasFetched) {
  SocketCan a("vcan0");
  SocketCan b("vcan0");
  const Time before = now();
  a.send(Frame(0x080, {}));
  const Time sent = now();
  std::this_thread::sleep_for(milliseconds(100));
  const auto received = receiveWithin(b, kPatience);
  ASSERT_TRUE(received);
  EXPECT_GE(received->stamp, before - milliseconds(1));
  EXPECT_LE(received->stamp, sent + milliseconds(20));
}

TEST_F(SocketCanOnVcan, KeepsItsStampsWhenTheWallClockIsStepped) {
  // Only where the clock is nobody else's; the arithmetic is tested in wall_clock_test.cpp.
  const auto step = [](std::int64_t seconds) {
    if (!onUserModeLinux()) return;
    timespec wall{};
    ::clock_gettime(CLOCK_REALTIME, &wall);
    wall.tv_sec += seconds;
    ASSERT_EQ(::clock_settime(CLOCK_REALTIME, &wall), 0);
  };
  SocketCan a("vcan0");
  SocketCan b("vcan0");
  for (const std::int64_t seconds : {-3600, 7200, -3600}) {
    expectStampBetweenSendAndReceive(a, b);
    const Time before = now();
    ASSERT_TRUE(a.send(Frame(0x080, {})));
    step(seconds);  // with the frame in the socket
    const auto received = receiveWithin(b, kPatience);
    ASSERT_TRUE(received);
    EXPECT_GE(received->stamp, before - milliseconds(1));
    EXPECT_LE(received->stamp, now());
    expectStampBetweenSendAndReceive(a, b);
  }
}

TEST_F(SocketCanOnVcan, SurvivesTheInterfaceGoingDownAndUp) {
  SocketCan a("vcan0", options());
  SocketCan b("vcan0", options());
  ASSERT_TRUE(run("ip link set vcan0 down"));
  ASSERT_TRUE(becomes(a, BusState::down));
  EXPECT_THAT(a.describe(), HasSubstr("ip link set vcan0 up"));
  EXPECT_FALSE(a.send(Frame(0x201, {1})));
  EXPECT_EQ(a.counters().frames_dropped, 1u);

  ASSERT_TRUE(run("ip link set vcan0 up"));
  ASSERT_TRUE(becomes(a, BusState::error_active)) << a.describe();
  ASSERT_TRUE(becomes(b, BusState::error_active)) << b.describe();
  EXPECT_TRUE(a.send(Frame(0x202, {2})));
  EXPECT_THAT(receivedIds(b), ElementsAre(0x202));
}

TEST_F(SocketCanOnVcan, NoticesADownInterfaceBySendingBeforeItLooks) {
  SocketCan a("vcan0");
  ASSERT_TRUE(run("ip link set vcan0 down"));
  EXPECT_FALSE(a.send(Frame(0x201, {1})));
  EXPECT_EQ(a.state(), BusState::down);
  EXPECT_EQ(a.counters().frames_dropped, 1u);
}

TEST_F(SocketCanOnVcan, WaitsForAnInterfaceThatIsDownAtTheStart) {
  ASSERT_TRUE(run("ip link set vcan0 down"));
  SocketCan a("vcan0", options());
  EXPECT_EQ(a.state(), BusState::down);
  ASSERT_TRUE(run("ip link set vcan0 up"));
  ASSERT_TRUE(becomes(a, BusState::error_active)) << a.describe();
  EXPECT_TRUE(a.send(Frame(0x080, {})));
}

TEST_F(SocketCanOnVcan, SurvivesTheInterfaceBeingRemovedAndCreatedAgain) {
  SocketCan a("vcan0", options());
  SocketCan b("vcan0", options());
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(run("ip link del vcan0"));
    ASSERT_TRUE(becomes(a, BusState::missing));
    EXPECT_EQ(a.fd(), -1);
    EXPECT_THAT(a.describe(), HasSubstr("vcan0 does not exist"));
    EXPECT_FALSE(a.send(Frame(0x201, {1})));

    ASSERT_TRUE(run("ip link add dev vcan0 type vcan"));
    ASSERT_TRUE(becomes(a, BusState::down)) << a.describe();
    EXPECT_FALSE(a.send(Frame(0x201, {1})));
    ASSERT_TRUE(run("ip link set vcan0 up"));
    ASSERT_TRUE(becomes(a, BusState::error_active)) << a.describe();
    ASSERT_TRUE(becomes(b, BusState::error_active)) << b.describe();
    EXPECT_TRUE(a.send(Frame(0x202, {2})));
    EXPECT_THAT(receivedIds(b), ElementsAre(0x202));
  }
  EXPECT_EQ(a.counters().frames_dropped, 4u);
  EXPECT_EQ(a.counters().frames_sent, 2u);
}

TEST_F(SocketCanOnVcan, NoticesAnInterfaceExchangedBetweenTwoLooks) {
  SocketCan a("vcan0", options());
  SocketCan b("vcan0", options());
  ASSERT_TRUE(run("ip link del vcan0 && ip link add dev vcan0 type vcan && ip link set vcan0 up"));
  // By looking alone: no receive() has met the error that the old socket holds.
  a.maintain(now());
  b.maintain(now());
  ASSERT_EQ(a.state(), BusState::error_active) << a.describe();
  EXPECT_TRUE(a.send(Frame(0x202, {2})));
  EXPECT_THAT(receivedIds(b), ElementsAre(0x202));
}

TEST_F(SocketCanOnVcan, FollowsTheErrorFramesOfTheController) {
  SocketCan can("vcan0", options());
  PlainSocket driver;
  ASSERT_TRUE(driver.send(CAN_ERR_FLAG | 0x204, {0, 0x20, 0, 0, 0, 0, 128, 3}));
  auto received = receiveWithin(can, kPatience);
  ASSERT_TRUE(received);
  EXPECT_TRUE(received->frame.error);
  EXPECT_EQ(received->frame.id, 0x204u);
  EXPECT_EQ(can.state(), BusState::error_passive);
  EXPECT_THAT(can.describe(), HasSubstr("transmit errors 128, receive errors 3"));
  EXPECT_TRUE(can.send(Frame(0x080, {})));

  ASSERT_TRUE(driver.send(CAN_ERR_FLAG | 0x004, {0, 0x01, 0, 0, 0, 0, 0, 0}));
  ASSERT_TRUE(receiveWithin(can, kPatience));
  EXPECT_EQ(can.counters().receive_overflows, 1u);

  ASSERT_TRUE(driver.send(CAN_ERR_FLAG | 0x040, {0, 0, 0, 0, 0, 0, 0, 0}));
  ASSERT_TRUE(receiveWithin(can, kPatience));
  EXPECT_EQ(can.state(), BusState::bus_off);
  EXPECT_THAT(can.describe(), HasSubstr("restart-ms"));
  EXPECT_FALSE(can.send(Frame(0x080, {})));
  EXPECT_EQ(can.counters().bus_off_events, 1u);
  std::this_thread::sleep_for(milliseconds(30));
  can.maintain(now());  // the carrier of vcan never goes: no proof that the controller is back
  EXPECT_EQ(can.state(), BusState::bus_off);

  ASSERT_TRUE(driver.send(CAN_ERR_FLAG | 0x100, {0, 0, 0, 0, 0, 0, 0, 0}));
  ASSERT_TRUE(receiveWithin(can, kPatience));
  EXPECT_EQ(can.state(), BusState::error_active);
  EXPECT_TRUE(can.send(Frame(0x080, {})));
  EXPECT_EQ(can.counters().error_frames, 4u);
  EXPECT_EQ(can.counters().frames_received, 0u);
}

TEST_F(SocketCanOnVcan, TakesAFrameFromTheBusAsProofThatBusOffIsOver) {
  SocketCan can("vcan0", options());
  PlainSocket driver;
  ASSERT_TRUE(driver.send(CAN_ERR_FLAG | 0x040, {0, 0, 0, 0, 0, 0, 0, 0}));
  ASSERT_TRUE(receiveWithin(can, kPatience));
  ASSERT_EQ(can.state(), BusState::bus_off);
  ASSERT_TRUE(driver.send(0x701, {5}));
  ASSERT_TRUE(receiveWithin(can, kPatience));
  EXPECT_EQ(can.state(), BusState::error_active);
}

TEST_F(SocketCanOnVcan, CountsFramesLostForWantOfRoomInTheKernel) {
  SocketCan::Options small = options();
  small.receive_buffer = 1;  // the kernel's minimum is about two kilobytes
  SocketCan slow("vcan0", small);
  SocketCan sender("vcan0");
  for (std::uint32_t i = 0; i < 200; ++i) ASSERT_TRUE(sender.send(Frame(0x181, {})));
  const std::size_t before = receivedIds(slow).size();
  EXPECT_LT(before, 200u);
  sender.send(Frame(0x182, {}));  // the kernel tells the loss with the next frame it keeps
  receivedIds(slow);
  EXPECT_EQ(slow.counters().receive_overflows, 200u - before);
}

// A queueing discipline that holds everything back until told to let go: the controller that cannot
// get its frames onto the bus.
class Plug {
 public:
  // `frames` fit into the kernel's queue; a classic frame counts as 16 bytes.
  explicit Plug(int frames) {
    const std::string add = "tc qdisc add dev vcan0 root handle 1: plug limit ";
    const std::string bytes = std::to_string(frames * 16);
    if (run(add + bytes)) {
      plugged = true;
    } else {
      run("insmod /usr/lib/uml/modules/$(uname -r)/kernel/net/sched/sch_plug.ko");
      plugged = run(add + bytes);
    }
    plugged = plugged && run("tc qdisc change dev vcan0 root handle 1: plug block");
  }
  void release() { run("tc qdisc change dev vcan0 root handle 1: plug release_indefinite"); }
  bool plugged = false;
};

TEST_F(SocketCanOnVcan, KeepsTheOrderOfFramesTheKernelHasNoRoomFor) {
  SocketCan a("vcan0", options());
  PlainSocket other_program;
  Plug plug(4);
  ASSERT_TRUE(plug.plugged) << "tc of iproute2 or the kernel module sch_plug is missing";
  for (std::uint32_t id = 0x201; id <= 0x214; ++id) ASSERT_TRUE(a.send(Frame(id, {})));
  const std::size_t waiting = a.pending();
  EXPECT_GT(waiting, 10u);
  EXPECT_EQ(a.counters().frames_deferred, waiting);
  EXPECT_EQ(a.counters().frames_sent, 20u - waiting);
  EXPECT_EQ(a.counters().frames_dropped, 0u);
  a.maintain(now());
  EXPECT_EQ(a.pending(), waiting);

  plug.release();
  a.maintain(now());
  EXPECT_EQ(a.pending(), 0u);
  ASSERT_TRUE(a.send(Frame(0x215, {})));
  EXPECT_EQ(a.counters().frames_sent, 21u);
  for (std::uint32_t id = 0x201; id <= 0x215; ++id) ASSERT_EQ(other_program.receivedId(), id);
}

TEST_F(SocketCanOnVcan, RefusesAndCountsWhatItsOwnQueueCannotHold) {
  SocketCan::Options options = this->options();
  options.queue_capacity = 3;
  SocketCan a("vcan0", options);
  Plug plug(4);
  ASSERT_TRUE(plug.plugged) << "tc of iproute2 or the kernel module sch_plug is missing";
  std::size_t taken = 0;
  for (int i = 0; i < 20; ++i) taken += a.send(Frame(0x201, {})) ? 1 : 0;
  EXPECT_EQ(a.pending(), 3u);
  EXPECT_EQ(a.counters().frames_deferred, 3u);
  EXPECT_EQ(a.counters().frames_dropped, 20u - taken);
  EXPECT_EQ(a.counters().frames_sent, taken - 3u);
}

TEST_F(SocketCanOnVcan, NeverSendsWhatWaitedBeforeAnInterruption) {
  SocketCan a("vcan0", options());
  SocketCan b("vcan0", options());
  Plug plug(4);
  ASSERT_TRUE(plug.plugged) << "tc of iproute2 or the kernel module sch_plug is missing";
  for (std::uint32_t id = 0x201; id <= 0x214; ++id) ASSERT_TRUE(a.send(Frame(id, {})));
  const std::size_t waiting = a.pending();
  ASSERT_GT(waiting, 0u);
  ASSERT_TRUE(run("ip link set vcan0 down"));
  ASSERT_TRUE(becomes(a, BusState::down));
  EXPECT_EQ(a.pending(), 0u);
  EXPECT_EQ(a.counters().frames_dropped, waiting);

  plug.release();
  run("tc qdisc del dev vcan0 root");
  ASSERT_TRUE(run("ip link set vcan0 up"));
  ASSERT_TRUE(becomes(b, BusState::error_active)) << b.describe();
  receivedIds(b);  // what other sockets saw before the interruption
  ASSERT_TRUE(becomes(a, BusState::error_active)) << a.describe();
  ASSERT_TRUE(a.send(Frame(0x080, {})));
  EXPECT_THAT(receivedIds(b), ElementsAre(0x080));
}

}  // namespace
}  // namespace cia402::can
