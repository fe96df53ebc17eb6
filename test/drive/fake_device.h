// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "drive/fake_drive.h"
#include "drive/fake_image.h"
#include "drive/fake_objects.h"
#include "fieldbus/device.h"

namespace cia402::drive::test {

/// A device at no bus: it starts, is lost and exchanges values with a FakeDrive as the calls of the
/// test say.
class FakeDevice final : public fieldbus::Device {
 public:
  FakeDevice(const Layout& layout, FakeDrive& drive)
      : FakeDevice(std::make_unique<State>(layout, drive)) {}

  // The device as an axis knows it.
  const std::string& bootStep() const override { return state_->step; }
  const std::string& problem() const override { return state_->problem; }
  fieldbus::DeviceTimes times() const override { return {kBootTime, state_->objects.defaults}; }
  const std::optional<fieldbus::Emergency>& lastEmergency() const override {
    return state_->emergency;
  }
  bool noticesLostMaster() const override { return state_->notices_lost_master; }
  bool seesToMotors() const override { return false; }
  bool excused() const override { return false; }
  fieldbus::ObjectAccess& objects() override { return state_->objects; }
  void boot(Time now, bool reset) override { state_->boot(now, reset, {}); }
  void restart(Time now) override { boot(now, true); }
  std::string restartGap() const override { return {}; }
  void stopAndStart(Duration stopped, Time now) override {
    if (ready()) state_->start_at = now + stopped;
  }
  bool paused() const override { return state_->start_at.has_value(); }
  const fieldbus::Terms& terms() const override { return kTerms; }
  std::string askingRefusal(const std::string&) const override { return {}; }
  std::string overdueText() const override { return state_->image.overdueText(); }
  std::string missingText() const override { return state_->image.missingText(); }
  std::string carrierText(fieldbus::Slot output) const override {
    return state_->image.carrierText(output);
  }

  // What happens to it, and its part of a cycle in this order.
  /// A sign of life of the drive: where it was away it is booted.
  void hear(Time now) {
    state_->heard_at = now;
    if (state_->begun && isAway(health())) boot(now, false);
  }
  void age() {
    if (ready()) state_->image.age();
  }
  /// Inputs come. @param by_test or from the drive
  void bring(const Values& values, bool by_test, Time now) {
    if (ready()) state_->image.bring(values, by_test, now);
  }
  /// The outputs leave.
  void send() {
    if (ready()) state_->drive.receive(state_->image.leave());
  }
  /// What was asked for is done, and the boot procedure goes on.
  void exchange(Time now) { state_->exchange(now); }
  /// Time passes: a drive that has given no sign of life for too long is lost.
  void supervise(Time now) { state_->supervise(now); }
  /// The drive has started anew.
  void restarted(Time now) { state_->restarted(now); }
  void hearEmergency(std::uint16_t code, Time now) {
    state_->emergency = {code, 0x21, {}, fieldbus::Emergency::kSize, now};
    ++state_->changes;
  }
  void noticeLostMaster(bool notices) { state_->notices_lost_master = notices; }
  void confirm(fieldbus::ObjectId object) { state_->objects.confirm(object); }
  void leaveOut(fieldbus::ObjectId output) { state_->image.leaveOut(output); }

  static constexpr fieldbus::Terms kTerms = {"node",
                                             "node-ID or bit rate",
                                             "PDO",
                                             "TPDO",
                                             "RPDO",
                                             "SDO",
                                             "EMCY",
                                             "NMT stop and start",
                                             "no RPDO reached it in time (1400:05)",
                                             "the bus and the COB-IDs of its RPDOs"};
  static constexpr Duration kBootTime = std::chrono::seconds(5);
  static constexpr Duration kSilence = std::chrono::milliseconds(300);  ///< then it is lost

 private:
  struct State : Front {
    bool notices_lost_master = true;
    State(const Layout& layout, FakeDrive& its_drive)
        : drive(its_drive), image(layout), objects(its_drive) {
      process = &image;
    }

    /// Whatever was known of the device or on its way to it is void.
    void takeOut(fieldbus::Health as, const std::string& why) {
      objects.cancelAll(why.empty() ? "the node is booted again" : "the node " + why);
      image.invalidate();
      answer.reset();
      start_at.reset();
      reset_due = false;
      health = as;
      problem = why.empty() ? std::string() : kWho + why;
      step = "not running";
      ++changes;
    }
    void boot(Time now, bool reset, const std::string& why) {
      begun = true;
      takeOut(fieldbus::Health::booting, why);
      absent_at = now + kBootTime;
      reset_due = reset;
      if (reset) {
        step = "waiting for boot-up";
      } else {
        if (!drive.dead) drive.operational = false;
        identify();
      }
    }
    void identify() {
      step = "reading 1000:00 device type";
      answer = objects.upload({0x1000, 0}, "device type");
    }
    void restarted(Time now) {
      ++boot_ups;
      ++changes;
      if (!begun) return;
      boot(now, false,
           health == fieldbus::Health::ready
               ? "rebooted by itself (boot-up message in operation): look for a power dip or a "
                 "watchdog reset; it is configured again and stays disabled"
               : "");
    }
    void exchange(Time now) {
      if (reset_due && !drive.dead) {
        drive.reboot();
        restarted(now);
      }
      objects.work(now);
      if (health == fieldbus::Health::booting) continueBoot(now);
      if (start_at) continuePause(now);
    }
    void continueBoot(Time now) {
      if (answer && answer->ok()) {
        answer.reset();
        drive.operational = true;
        health = fieldbus::Health::ready;
        problem.clear();
        step = "ready";
        heard_at = now;
        ++changes;
      } else if (now >= absent_at) {
        takeOut(fieldbus::Health::absent,
                "does not answer: neither a boot-up message nor an answer to reading 1000:00 "
                "device type came within 5 s; check power, cable and termination, bit rate and "
                "node-ID");
      } else if (answer && answer->done()) {
        identify();
      }
    }
    void continuePause(Time now) {
      if (now >= *start_at + kStartPatience) {
        boot(now, false, "was stopped for a fault reset and did not become operational again");
      } else if (!drive.dead) {
        drive.operational = now >= *start_at;
        if (drive.operational) start_at.reset();
      }
    }
    void supervise(Time now) {
      if (health != fieldbus::Health::ready || now < heard_at + kSilence) return;
      takeOut(fieldbus::Health::lost,
              "no heartbeat for 0.3 s: check power and cable; it is configured again when it is "
              "back");
    }

    static constexpr char kWho[] = "shoulder (node 3): ";

    FakeDrive& drive;
    FakeImage image;
    FakeObjects objects;
    std::string step, problem;
    std::optional<fieldbus::Emergency> emergency;
    bool begun = false;       ///< boot() was called once; before that nothing starts by itself
    bool reset_due = false;   ///< the drive has not heard of its reset yet
    fieldbus::Ticket answer;  ///< that proves while it boots that the drive is there
    Time absent_at{};         ///< while it boots: then it is not there
    Time heard_at{};
    std::optional<Time> start_at;  ///< of a drive that was taken out of operation for a while
  };

  explicit FakeDevice(std::unique_ptr<State> state) : Device(*state), state_(std::move(state)) {}

  std::unique_ptr<State> state_;
};

}  // namespace cia402::drive::test
