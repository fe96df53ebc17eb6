// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "can_vcan/vcan_fixture.h"

namespace cia402::can {
namespace {

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

TEST_F(SocketCanOnVcan, SendsNoCyclicFrameThatWaitedTooLongAndOnlyTheNewest) {
  SocketCan::Options options = this->options();
  options.cyclic.set(0x201);
  options.cyclic_lifetime = milliseconds(50);
  SocketCan a("vcan0", options);
  PlainSocket other_program;
  Plug plug(4);
  ASSERT_TRUE(plug.plugged) << "tc of iproute2 or the kernel module sch_plug is missing";
  while (a.pending() == 0) ASSERT_TRUE(a.send(Frame(0x700, {})));
  const std::uint64_t in_kernel = a.counters().frames_sent;
  for (std::uint8_t i = 0; i < 5; ++i) ASSERT_TRUE(a.send(Frame(0x201, {i})));
  ASSERT_TRUE(a.send(Frame(0x601, {})));
  EXPECT_EQ(a.pending(), 3u) << "0x700, the newest 0x201, 0x601";
  EXPECT_EQ(a.counters().frames_stale, 4u);
  std::this_thread::sleep_for(milliseconds(60));
  plug.release();
  a.maintain(now());
  EXPECT_EQ(a.counters().frames_stale, 5u);
  for (std::uint64_t i = 0; i < in_kernel + 1; ++i) ASSERT_EQ(other_program.receivedId(), 0x700u);
  EXPECT_EQ(other_program.receivedId(), 0x601u);
}

}  // namespace
}  // namespace cia402::can
