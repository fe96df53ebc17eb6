// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "bus/dcf_world.h"

namespace cia402::bus::test {

struct DcfDraftTest : DcfWorld {
  /// The file, or why there is none.
  DcfAnswer save(const drive::AxisConfig& config, const canopen::DeviceConfig& device) {
    DcfDraft draft(config, device, stamp());
    DcfAnswer answer;
    static_cast<Answer&>(answer) = world.call(draft.command());
    return answer.success ? draft.finish() : answer;
  }
  DcfAnswer save(std::size_t axis = 0) {
    return save(world.axis(axis).config(), world.device(axis));
  }
  /// That of the shoulder, as if its EDS were another.
  DcfAnswer saveWithEds(const std::string& text) {
    drive::AxisConfig config = world.axis(0).config();
    const config::RobotConfig robot = robotWithEds(text);
    config.description = robot.axes[0].description;
    return save(config, robot.devices[0]);
  }
  /// The drive of the elbow, which has no EDS, without any communication object.
  FakeDrive& bareDrive() {
    FakeDrive& drive = world.drives[1];
    for (std::uint32_t index = 0x1000; index < 0x2000; ++index) {
      for (std::uint8_t subindex = 0; subindex < 9; ++subindex) {
        const fieldbus::ObjectId id{static_cast<std::uint16_t>(index), subindex};
        drive.aborts[id] = subindex == 0 ? 0x06020000 : 0x06090011;
      }
    }
    return drive;
  }
  void give(fieldbus::ObjectId id, const Bytes& data) {
    world.drives[1].aborts.erase(id);
    world.drives[1].objects[id] = data;
  }
};

/// An object of an EDS: an uint16 that can be written.
inline std::string word(const std::string& index) {
  return "[" + index + "]\nParameterName=Word " + index + "\nDataType=6\nAccessType=rw\n";
}

}  // namespace cia402::bus::test
