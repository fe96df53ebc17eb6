// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <vector>

#include "sim/device/device.h"

namespace cia402::sim::testing_support {

using std::chrono::microseconds;
using std::chrono::milliseconds;

/// Frames as text, "581 60 17 10 00", to be compared with bytes written by hand.
inline std::string toText(const can::Frame& frame) {
  char text[8];
  std::snprintf(text, sizeof(text), "%03X", static_cast<unsigned>(frame.id));
  std::string line = text;
  for (std::size_t i = 0; i < frame.size; ++i) {
    std::snprintf(text, sizeof(text), " %02X", static_cast<unsigned>(frame.data[i]));
    line += text;
  }
  return line;
}

struct RecordingSink : can::Sink {
  std::vector<std::string> frames;
  bool send(const can::Frame& frame) override {
    frames.push_back(toText(frame));
    return true;
  }
};

struct RecordingApplication : Device::Application {
  std::vector<std::string> calls;
  bool fault = false;
  void onPowerOn(Time) override { calls.push_back("power on"); }
  void onNmtState(canopen::NmtState state, Time) override {
    char text[16];
    std::snprintf(text, sizeof(text), "state %02X", static_cast<unsigned>(state));
    calls.push_back(text);
  }
  void onSync(Time) override { calls.push_back("sync"); }
  void onRpdo(Time) override { calls.push_back("rpdo"); }
  void onMasterLost(Time) override { calls.push_back("lost"); }
  void onMasterBack(Time) override { calls.push_back("back"); }
  void beforeTpdo(Time) override { calls.push_back("before tpdo"); }
  bool hasFault() const override { return fault; }
};

/// Node 1 with four RPDOs and TPDOs and the objects of a small drive; no SDO latency.
class SlaveTest : public testing::Test {
 protected:
  SlaveTest() {
    add(0x1000, 0, DataType::uint32, Access::constant, 0x00020192);
    add(0x1001, 0, DataType::uint8, Access::ro);
    add(0x1003, 0, DataType::uint8, Access::rw);
    for (std::uint8_t sub = 1; sub <= 3; ++sub) add(0x1003, sub, DataType::uint32, Access::ro);
    add(0x1005, 0, DataType::uint32, Access::rw, 0x80);
    add(0x1006, 0, DataType::uint32, Access::rw);
    add(0x1014, 0, DataType::uint32, Access::rw, 0x81);
    add(0x1015, 0, DataType::uint16, Access::rw);
    add(0x1016, 0, DataType::uint8, Access::constant, 2);
    add(0x1016, 1, DataType::uint32, Access::rw);
    add(0x1016, 2, DataType::uint32, Access::rw);
    add(0x1017, 0, DataType::uint16, Access::rw);
    add(0x1019, 0, DataType::uint8, Access::rw);
    add(0x1029, 0, DataType::uint8, Access::constant, 1);
    add(0x1029, 1, DataType::uint8, Access::rw);
    for (std::uint16_t pdo = 0; pdo < 4; ++pdo) addPdos(pdo);
    addMapped(0x6040, DataType::uint16, Access::rw);
    addMapped(0x6041, DataType::uint16, Access::ro);
    addMapped(0x6060, DataType::int8, Access::rw);
    addMapped(0x6061, DataType::int8, Access::ro);
    addMapped(0x6064, DataType::int32, Access::ro);
    addMapped(0x607A, DataType::int32, Access::rw);
    add(0x6065, 0, DataType::uint32, Access::rw);
    behaviour.sdo_latency = Duration::zero();
  }

  Entry& add(std::uint16_t index, std::uint8_t sub, DataType type, Access access,
             std::uint64_t number = 0) {
    Entry entry;
    entry.id = {index, sub};
    entry.type = type;
    entry.access = access;
    entry.number = number;
    return dictionary.add(entry);
  }

  void addMapped(std::uint16_t index, DataType type, Access access) {
    Entry& entry = add(index, 0, type, access);
    entry.tpdo = true;
    entry.rpdo = access == Access::rw;
  }

  void addPdos(std::uint16_t pdo) {
    const auto at = [&](unsigned base) { return static_cast<std::uint16_t>(base + pdo); };
    add(at(0x1400), 0, DataType::uint8, Access::constant, 5);
    add(at(0x1400), 1, DataType::uint32, Access::rw, 0x80000201U + 0x100U * pdo);
    add(at(0x1400), 2, DataType::uint8, Access::rw, 255);
    add(at(0x1400), 5, DataType::uint16, Access::rw);
    add(at(0x1800), 0, DataType::uint8, Access::constant, 6);
    add(at(0x1800), 1, DataType::uint32, Access::rw, 0x80000181U + 0x100U * pdo);
    add(at(0x1800), 2, DataType::uint8, Access::rw, 255);
    add(at(0x1800), 3, DataType::uint16, Access::rw);
    add(at(0x1800), 5, DataType::uint16, Access::rw);
    add(at(0x1800), 6, DataType::uint8, Access::rw);
    for (std::uint8_t sub = 0; sub <= 8; ++sub) {
      const DataType type = sub == 0 ? DataType::uint8 : DataType::uint32;
      add(at(0x1600), sub, type, Access::rw);
      add(at(0x1A00), sub, type, Access::rw);
    }
  }

  /// Sets a power-on value.
  void preset(std::uint16_t index, std::uint8_t sub, std::uint64_t number) {
    Entry* entry = dictionary.find({index, sub});
    entry->number = number;
    entry->initial_number = number;
  }

  /// RPDO1 = 6040h, 607Ah and TPDO1 = 6041h, 6064h, both valid, of these transmission types.
  void presetPdos(std::uint64_t rpdo_type, std::uint64_t tpdo_type) {
    preset(0x1400, 1, 0x201);
    preset(0x1400, 2, rpdo_type);
    preset(0x1600, 0, 2);
    preset(0x1600, 1, 0x60400010);
    preset(0x1600, 2, 0x607A0020);
    preset(0x1800, 1, 0x181);
    preset(0x1800, 2, tpdo_type);
    preset(0x1A00, 0, 2);
    preset(0x1A00, 1, 0x60410010);
    preset(0x1A00, 2, 0x60640020);
  }

  /// Powers on and runs to pre-operational; forgets the frames and calls until then.
  void boot() {
    device.behaviour() = behaviour;
    device.powerOn(now);
    run(behaviour.boot_time);
    forget();
  }

  /// The same, then to operational.
  void operate() {
    boot();
    send(0x000, {0x01, 0x01});
    forget();
  }

  void send(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) {
    device.receive(can::Frame(id, bytes), now);
  }

  void requestRemote(std::uint32_t id) {
    can::Frame frame;
    frame.id = id;
    frame.remote = true;
    device.receive(frame, now);
  }

  /// Lets virtual time pass, event by event.
  void run(Duration duration) {
    const Time end = now + duration;
    while (device.nextEvent() <= end) {
      now = std::max(now, device.nextEvent());
      device.tick(now);
    }
    now = end;
  }

  void forget() {
    sink.frames.clear();
    application.calls.clear();
  }

  /// The frames since the last call.
  std::vector<std::string> sent() {
    std::vector<std::string> frames;
    frames.swap(sink.frames);
    return frames;
  }

  /// Sends an SDO request to node 1; the answer to it.
  std::string sdo(std::initializer_list<std::uint8_t> bytes) {
    forget();
    send(0x601, bytes);
    std::string answer = "none";
    for (const std::string& frame : sent()) {
      if (frame.compare(0, 3, "581") == 0) answer = frame;
    }
    return answer;
  }

  std::uint64_t value(std::uint16_t index, std::uint8_t sub = 0) {
    return dictionary.find({index, sub})->number;
  }
  void setValue(std::uint16_t index, std::uint64_t number) {
    dictionary.find({index, 0})->number = number;
  }

  Time now{};
  ObjectDictionary dictionary;
  RecordingSink sink;
  RecordingApplication application;
  DeviceBehaviour behaviour;
  Device device{1, sink, dictionary, behaviour, application};
};

}  // namespace cia402::sim::testing_support
