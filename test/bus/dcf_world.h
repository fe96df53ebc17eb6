// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "bus/canopen/dcf_draft.h"
#include "bus/robot_world.h"

namespace cia402::bus::test {

inline const char* const kEds = R"([DeviceInfo]
VendorNumber=0x123
NrOfTXPDO=1
[2001]
ParameterName=Gain
DataType=6
AccessType=rw
DefaultValue=5
[2002]
ParameterName=Command
DataType=6
AccessType=wo
[2003]
ParameterName=Length differs
DataType=7
AccessType=rw
[2004]
ParameterName=Not there
DataType=7
AccessType=rw
[2005]
ParameterName=Name
DataType=9
AccessType=ro
[2006]
ParameterName=Not to be scanned
DataType=6
AccessType=rw
ObjFlags=2
)";

inline config::RobotConfig robotWithEds(const std::string& text = kEds) {
  config::RobotConfig robot = testRobot();
  canopen::Eds eds = canopen::readEds(text, canopen::NodeId{1});
  robot.axes[0].description = std::make_shared<const fieldbus::DeviceDescription>(
      fieldbus::DeviceDescription{"motor.eds", eds.dictionary});
  robot.devices[0].eds = std::make_shared<const canopen::EdsInfo>(eds.info);
  return robot;
}

/// A shoulder with an EDS and its objects, an elbow without.
struct DcfWorld : testing::Test {
  DcfWorld() : world(robotWithEds()) {
    world.boot();
    world.drives[0].objects[fieldbus::ObjectId{0x2001, 0}] = {0x34, 0x12};
    world.drives[0].objects[fieldbus::ObjectId{0x2002, 0}] = {1, 0};
    world.drives[0].objects[fieldbus::ObjectId{0x2003, 0}] = {1, 0};
    world.drives[0].objects[fieldbus::ObjectId{0x2005, 0}] = {'M', '7', 0, 0};
    world.drives[0].objects[fieldbus::ObjectId{0x2006, 0}] = {1, 0};
  }
  static DcfStamp stamp() { return {"shoulder.dcf", "11-21-2026", "03:40PM"}; }
  RobotWorld world;
};

}  // namespace cia402::bus::test
