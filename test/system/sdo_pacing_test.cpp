// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A long SDO transfer beside the cycle, through an interface whose queue is first in, first out.
#include <gtest/gtest.h>

#include <deque>
#include <functional>

#include "can/pacer.h"
#include "canopen/sdo/client.h"
#include "sim/bus/bus.h"
#include "sim/device/device.h"

namespace cia402 {
namespace {

using fieldbus::Bytes;
using std::chrono::microseconds;

constexpr Duration kFrame = microseconds(135);  // eight bytes with all stuff bits, 1 Mbit/s
constexpr fieldbus::ObjectId kProgram{0x1F50, 1};

/// A master that sends SYNC and downloads, a device that takes it, and a third party that fills
/// half of the bus with TPDOs.
class PacedBus : private sim::Listener, private sim::Device::Application {
 public:
  PacedBus(bool paced, Duration sync_period, Duration tpdo_period)
      : port_(bus_.attach(*this, "master")),
        pacer_(port_, 1e6),
        client_(1, paced ? static_cast<can::Sink&>(pacer_) : port_, {}, {},
                paced ? &pacer_ : nullptr),
        device_port_(bus_.attach(device_listener_, "device")),
        device_(1, device_port_, dictionary_, {}, *this),
        other_port_(bus_.attach(silent_, "others")),
        sync_period_(sync_period),
        tpdo_period_(tpdo_period) {
    port_.setFirstInFirstOut(true);
    sim::Entry program;
    program.id = kProgram;
    program.type = sim::DataType::domain;
    dictionary_.add(program);
    device_.powerOn(now_);
    bus_.setMonitor([this](const can::Frame& frame, Time end) {
      if (frame.id != 0x80) return;
      longest_delay_ = std::max(longest_delay_, end - sync_sent_.front());
      sync_sent_.pop_front();
    });
  }

  /// @return how long the download took.
  Duration download(std::size_t size) {
    Bytes data(size);
    for (std::size_t i = 0; i < size; ++i) data[i] = static_cast<std::uint8_t>(i * 37 + i / 300);
    while (now_ < Time(microseconds(100'000))) step();
    const Time begin = now_;
    const canopen::SdoTicket ticket = client_.download(kProgram, data);
    while (!ticket->done() && now_ - begin < std::chrono::seconds(20)) step();
    EXPECT_TRUE(ticket->ok()) << ticket->message();
    EXPECT_EQ(dictionary_.find(kProgram)->bytes, data);
    return now_ - begin;
  }
  /// From the moment in which SYNC was given to the interface to its end on the wire.
  Duration longestDelay() const { return longest_delay_; }

 private:
  struct DeviceListener final : sim::Listener {
    explicit DeviceListener(PacedBus& bus) : owner(bus) {}
    void onFrame(const can::Frame& frame, Time now) override { owner.device_.receive(frame, now); }
    PacedBus& owner;
  };
  struct Silent final : sim::Listener {
    void onFrame(const can::Frame&, Time) override {}
  };

  void onFrame(const can::Frame& frame, Time now) override {
    pacer_.setTime(now);
    pacer_.heard(frame, now);
    if (frame.id == client_.answerId()) client_.receive(frame, now);
  }
  void step() {
    now_ = std::max(now_, std::min({bus_.nextEvent(), client_.nextDeadline(), device_.nextEvent(),
                                    next_sync_, next_tpdo_}));
    bus_.setTime(now_);
    bus_.advance(now_);
    pacer_.setTime(now_);
    // The worst order: what is due at the same moment goes before SYNC.
    if (client_.nextDeadline() <= now_) client_.tick(now_);
    if (next_sync_ <= now_) {
      sync_sent_.push_back(now_);
      pacer_.send(can::Frame(0x80, {}));
      pacer_.syncSent(now_, sync_period_);
      next_sync_ += sync_period_;
    }
    if (next_tpdo_ <= now_) {
      other_port_.send(can::Frame(0x185, {1, 2, 3, 4, 5, 6, 7, 8}));
      next_tpdo_ += tpdo_period_;
    }
    device_.tick(now_);
  }

  Time now_{};
  sim::Bus bus_{1e6};
  DeviceListener device_listener_{*this};
  Silent silent_;
  sim::Port& port_;
  can::Pacer pacer_;
  canopen::SdoClient client_;
  sim::ObjectDictionary dictionary_;
  sim::Port& device_port_;
  sim::Device device_;
  sim::Port& other_port_;
  Duration sync_period_, tpdo_period_, longest_delay_{};
  std::deque<Time> sync_sent_;
  Time next_sync_{}, next_tpdo_{microseconds(137)};
};

constexpr Duration kNoTpdos = std::chrono::hours(1);

TEST(SdoPacing, without_it_a_sub_block_holds_up_sync_by_many_milliseconds) {
  PacedBus bus(false, microseconds(4000), kNoTpdos);
  bus.download(20'000);
  EXPECT_GT(bus.longestDelay(), microseconds(10'000));
}

TEST(SdoPacing, a_download_delays_sync_by_few_frames_at_most) {
  for (const int period_us : {1000, 2000, 4000, 10'000}) {
    PacedBus bus(true, microseconds(period_us), kNoTpdos);
    bus.download(100'000);
    // One that is on the wire already, one sent just before, SYNC itself.
    EXPECT_LE(bus.longestDelay(), 3 * kFrame) << period_us;
  }
}

TEST(SdoPacing, also_while_others_fill_half_of_the_bus) {
  for (const int period_us : {1000, 4000}) {
    PacedBus bus(true, microseconds(period_us), microseconds(257));
    bus.download(100'000);
    EXPECT_LE(bus.longestDelay(), 5 * kFrame) << period_us;
  }
}

TEST(SdoPacing, leaves_the_rest_of_the_bus_to_the_download) {
  PacedBus bus(true, microseconds(4000), kNoTpdos);
  const Duration took = bus.download(100'000);
  // 14,286 segments of at most 135 bits; the data here need 120 on average.
  EXPECT_LT(took, 14'286 * microseconds(135));
}

}  // namespace
}  // namespace cia402
