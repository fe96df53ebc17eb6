// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "scripted_drives.h"

#include <algorithm>

namespace cia402::benchmark {
namespace {

constexpr std::uint32_t kNoSuchObject = 0x06020000;

std::uint32_t word(const can::Frame& frame, std::size_t from) {
  return static_cast<std::uint32_t>(frame.data[from]) |
         static_cast<std::uint32_t>(frame.data[from + 1]) << 8 |
         static_cast<std::uint32_t>(frame.data[from + 2]) << 16 |
         static_cast<std::uint32_t>(frame.data[from + 3]) << 24;
}

std::uint8_t byte(std::uint32_t value, int number) {
  return static_cast<std::uint8_t>(value >> (8 * number) & 0xFF);
}

}  // namespace

void ScriptedDrives::receive(const can::Frame& frame, std::vector<can::Frame>& out) {
  if (frame.id == 0x000) return onNmt(frame, out);
  if (frame.id == 0x080) return onSync(out);
  const std::size_t node = frame.id & 0x7F;
  if (node == 0 || node >= drives_.size()) return;
  if ((frame.id & 0x780) == 0x600) onSdo(drives_[node], frame, out);
  if ((frame.id & 0x780) == 0x200) onRpdo(drives_[node], frame);
}

void ScriptedDrives::tick(Time now, std::vector<can::Frame>& out) {
  if (now < next_heartbeat_) return;
  next_heartbeat_ = kNever;
  for (std::uint32_t node = 1; node < drives_.size(); ++node) {
    Drive& drive = drives_[node];
    if (drive.heartbeat == Duration{}) continue;
    if (drive.next_heartbeat <= now) {
      drive.next_heartbeat = now + drive.heartbeat;
      out.push_back({0x700 + node, {static_cast<std::uint8_t>(drive.operational ? 5 : 0x7F)}});
    }
    next_heartbeat_ = std::min(next_heartbeat_, drive.next_heartbeat);
  }
}

void ScriptedDrives::onNmt(const can::Frame& frame, std::vector<can::Frame>& out) {
  for (std::uint32_t node = 1; node < drives_.size(); ++node) {
    if (frame.data[1] != 0 && frame.data[1] != node) continue;
    drives_[node].operational = frame.data[0] == 0x01;
    if (frame.data[0] != 0x81 && frame.data[0] != 0x82) continue;
    drives_[node] = Drive();
    out.push_back({0x700 + node, {0x00}});
  }
}

void ScriptedDrives::onSync(std::vector<can::Frame>& out) {
  for (std::uint32_t node = 1; node < drives_.size(); ++node) {
    const Drive& drive = drives_[node];
    if (!drive.operational) continue;
    out.push_back(
        {0x180 + node,
         {byte(drive.statusword, 0), byte(drive.statusword, 1), byte(drive.position, 0),
          byte(drive.position, 1), byte(drive.position, 2), byte(drive.position, 3), drive.mode}});
  }
}

void ScriptedDrives::onSdo(Drive& drive, const can::Frame& frame, std::vector<can::Frame>& out) {
  const fieldbus::ObjectId object{static_cast<std::uint16_t>(frame.data[1] | frame.data[2] << 8),
                                  frame.data[3]};
  const auto answer = [&](std::uint8_t command, std::uint32_t value) {
    out.push_back({frame.id - 0x80,
                   {command, frame.data[1], frame.data[2], frame.data[3], byte(value, 0),
                    byte(value, 1), byte(value, 2), byte(value, 3)}});
  };
  if ((frame.data[0] & 0xE0) == 0x20) {
    drive.objects[object] = word(frame, 4);
    if (object.index == 0x6060) drive.mode = frame.data[4];
    if (object.index == 0x1017) {
      drive.heartbeat = std::chrono::milliseconds(word(frame, 4) & 0xFFFF);
      drive.next_heartbeat = next_heartbeat_ = Time{};
    }
    answer(0x60, 0);
  } else if (frame.data[0] == 0x40) {
    const bool known = object.index < 0x2000 || drive.objects.count(object) != 0;
    answer(known ? 0x43 : 0x80, known ? drive.objects[object] : kNoSuchObject);
  }
}

void ScriptedDrives::onRpdo(Drive& drive, const can::Frame& frame) {
  if (!drive.operational) return;
  // CiA 402, commands by bits 0 to 3 of the controlword: there is no fault to leave here.
  static constexpr std::uint16_t kOff = 0x0250, kReady = 0x0231, kOn = 0x0233, kEnabled = 0x1237;
  switch (frame.data[0] & 0x0F) {
    case 0x06:
      drive.statusword = kReady;
      break;
    case 0x07:
      drive.statusword = drive.statusword == kOff ? kOff : kOn;
      break;
    case 0x0F:
      drive.statusword = drive.statusword == kOff ? kOff : kEnabled;
      break;
    default:
      drive.statusword = kOff;
      break;
  }
  if (drive.statusword == kEnabled) drive.position = word(frame, 2);
}

}  // namespace cia402::benchmark
