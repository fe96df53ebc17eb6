// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "folders.h"
#include "sim/drive/drive.h"

namespace cia402::sim {

inline Duration ms(double milliseconds) { return fromSeconds(milliseconds * 1e-3); }

/// One simulated drive (node 1) on a wire that a test reads and writes byte by byte, in virtual
/// time.
class DriveBench : public can::Sink {
 public:
  explicit DriveBench(const std::string& name, const AxisMechanics& mechanics = {})
      : DriveBench(loadDriveDefinition(cia402::test::configFolder() + "/simulated_drives/" + name +
                                       ".yaml"),
                   mechanics) {}
  DriveBench(const Result<std::shared_ptr<const DriveDefinition>>& definition,
             const AxisMechanics& mechanics) {
    EXPECT_TRUE(definition.ok()) << (definition.ok() ? "" : definition.error().message);
    drive = std::make_unique<Drive>(definition.value(), canopen::NodeId{1}, *this, mechanics);
    drive->powerOn(now);
    run(ms(100));
  }

  bool send(const can::Frame& frame) override {
    sent.push_back(frame);
    return true;
  }

  /// Lets virtual time pass, ticking when the drive asks for it.
  void run(Duration duration) {
    const Time end = now + duration;
    int idle_ticks = 0;  // a drive that asks for the past again and again would hang a world
    while (drive->nextEvent() <= end) {
      const Time next = drive->nextEvent();
      idle_ticks = next > now ? 0 : idle_ticks + 1;
      ASSERT_LT(idle_ticks, 10) << "nextEvent() does not advance";
      now = std::max(now, next);
      drive->tick(now);
    }
    now = std::max(now, end);
    drive->tick(now);
  }

  void frame(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) {
    drive->receive(can::Frame(id, bytes), now);
  }
  void nmt(std::uint8_t command) { frame(0x000, {command, 0x01}); }
  void sync() { frame(0x080, {}); }

  /// Sends eight bytes to the SDO server and returns the answer's.
  std::vector<std::uint8_t> sdo(std::initializer_list<std::uint8_t> request) {
    const std::size_t before = sent.size();
    frame(0x601, request);
    run(ms(1));
    for (std::size_t i = before; i < sent.size(); ++i) {
      if (sent[i].id == 0x581) return {sent[i].data.begin(), sent[i].data.end()};
    }
    ADD_FAILURE() << "no SDO answer";
    return std::vector<std::uint8_t>(8, 0);
  }
  std::uint32_t abortOf(std::initializer_list<std::uint8_t> request) {
    const auto answer = sdo(request);
    return answer[0] == 0x80 ? word32(answer, 4) : 0U;
  }
  /// Expedited download of `size` bytes; the answer must be 60h.
  void write(std::uint16_t index, std::uint8_t sub, std::uint32_t value, int size) {
    EXPECT_EQ(refusal(index, sub, value, size), 0U) << std::hex << index << ":" << int{sub};
  }
  std::uint32_t refusal(std::uint16_t index, std::uint8_t sub, std::uint32_t value, int size) {
    const std::uint8_t command = size == 1 ? 0x2F : size == 2 ? 0x2B : 0x23;
    return abortOf({command, low(index), high(index), sub, low(value), high(value),
                    low(value >> 16), high(value >> 16)});
  }
  std::uint32_t read(std::uint16_t index, std::uint8_t sub = 0) {
    const auto answer = sdo({0x40, low(index), high(index), sub, 0, 0, 0, 0});
    EXPECT_EQ(answer[0] & 0xE0, 0x40) << std::hex << index;
    return word32(answer, 4);
  }
  std::int32_t position() { return static_cast<std::int32_t>(read(0x6064)); }
  std::int32_t velocity() { return static_cast<std::int32_t>(read(0x606C)); }
  float readFloat(std::uint16_t index) {
    const std::uint32_t bits = read(index);
    float value = 0;
    std::memcpy(&value, &bits, 4);
    return value;
  }

  std::uint16_t status() { return drive->truth(now).statusword; }
  /// Statusword as a master reads it, state bits only (mask 0x6F).
  int state() { return static_cast<int>(read(0x6041) & 0x6F); }
  void control(std::uint16_t word) { write(0x6040, 0, word, 2); }
  void enable() {
    control(0x0006);
    control(0x0007);
    control(0x000F);
  }
  /// Emergency frames so far, error code and register.
  std::vector<std::pair<int, int>> emergencies() const {
    std::vector<std::pair<int, int>> found;
    for (const can::Frame& f : sent) {
      if (f.id == 0x081) found.emplace_back(f.data[0] | f.data[1] << 8, f.data[2]);
    }
    return found;
  }

  static std::uint8_t low(std::uint32_t value) { return static_cast<std::uint8_t>(value & 0xFF); }
  static std::uint8_t high(std::uint32_t value) {
    return static_cast<std::uint8_t>((value >> 8) & 0xFF);
  }
  static std::uint32_t word32(const std::vector<std::uint8_t>& bytes, std::size_t at) {
    return bytes[at] | static_cast<std::uint32_t>(bytes[at + 1]) << 8 |
           static_cast<std::uint32_t>(bytes[at + 2]) << 16 |
           static_cast<std::uint32_t>(bytes[at + 3]) << 24;
  }

  Time now{};
  std::vector<can::Frame> sent;
  std::unique_ptr<Drive> drive;
};

}  // namespace cia402::sim
