// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A profile as the further axes of a device have it (CiA 402-2: 800h indices from axis to axis).
#include <gmock/gmock.h>

#include "drive/profile/profile.h"

namespace cia402::drive {
namespace {

DriveProfile profile() {
  DriveProfile profile;
  ObjectSpec controlword, of_maker, register_of_device;
  controlword.name = "controlword";
  controlword.id = {0x6040, 0};
  of_maker.name = "of_maker";
  of_maker.id = {0x2000, 3};
  register_of_device.name = "error_register";
  register_of_device.id = {0x1001, 0};
  profile.objects = {controlword, of_maker, register_of_device};
  const auto write = [](const char* object) {
    NamedWrite named;
    named.object = object;
    return named;
  };
  profile.startup = {write("6065:00"), write("2000:03"), write("controlword"), write("6800:00")};
  profile.before_enable = {write("67FF:01")};
  profile.homing.writes = {write("6098:00")};
  profile.modes.resize(1);
  profile.modes[0].entry_writes = {write("607F:00")};
  profile.encodings.add({{0x6064, 0}, {0x6064, 0xFF}}, Encoding::float32);
  profile.encodings.add({{0x2000, 0}, {0x67FF, 0xFF}}, Encoding::bfloat16);
  profile.coordinates.add({{0x6064, 0}, {0x6064, 0xFF}}, CoordinateMark::calibration);
  return profile;
}

TEST(DeviceAxis, ObjectsOfCia402AreMovedAndThoseOfTheMakerAreNot) {
  const DriveProfile third = ofDeviceAxis(profile(), 2);
  EXPECT_EQ(third.find("controlword")->id, (ObjectId{0x7040, 0}));
  EXPECT_EQ(third.find("of_maker")->id, (ObjectId{0x2000, 3}));
  EXPECT_EQ(third.find("error_register")->id, (ObjectId{0x1001, 0}));
  EXPECT_EQ(third.own({0x605A, 0}), (ObjectId{0x705A, 0}));
  EXPECT_EQ(third.address(0x6041), "7041:00");
  EXPECT_EQ(ofDeviceAxis(profile(), 7).find("controlword")->id, (ObjectId{0x9840, 0}));
  EXPECT_EQ(ofDeviceAxis(profile(), 0).find("controlword")->id, (ObjectId{0x6040, 0}));
}

TEST(DeviceAxis, WritesByIndexAreMovedAndThoseByNameFollowTheirObject) {
  const DriveProfile second = ofDeviceAxis(profile(), 1);
  EXPECT_EQ(second.startup[0].object, "6865:00");
  EXPECT_EQ(second.startup[1].object, "2000:03");
  EXPECT_EQ(second.startup[2].object, "controlword");
  EXPECT_EQ(second.startup[3].object, "6800:00") << "not among those of axis 0";
  EXPECT_EQ(second.before_enable[0].object, "6FFF:01");
  EXPECT_EQ(second.homing.writes[0].object, "6898:00");
  EXPECT_EQ(second.modes[0].entry_writes[0].object, "687F:00");
}

TEST(DeviceAxis, RangesAreMovedWhereTheyAreOfTheAxisAlone) {
  const DriveProfile second = ofDeviceAxis(profile(), 1);
  EXPECT_EQ(second.encodingOf({0x6864, 0}, DataType::uint32), Encoding::float32);
  EXPECT_EQ(second.encodingOf({0x6064, 0}, DataType::uint32), Encoding::integer);
  EXPECT_EQ(second.encodingOf({0x2001, 0}, DataType::uint16), Encoding::bfloat16);
  EXPECT_EQ(second.coordinateMark({0x6864, 0}), CoordinateMark::calibration);
  EXPECT_EQ(second.coordinateMark({0x687C, 0}), CoordinateMark::home) << "by the standard";
}

TEST(DeviceAxis, AnObjectTellsWhoseItIs) {
  EXPECT_EQ(axisOf({0x5FFF, 0}), std::nullopt);
  EXPECT_EQ(axisOf({0x6000, 0}), 0U);
  EXPECT_EQ(axisOf({0x67FF, 0}), 0U);
  EXPECT_EQ(axisOf({0x6800, 0}), 1U);
  EXPECT_EQ(axisOf({0x9FFF, 0}), 7U);
  EXPECT_EQ(axisOf({0xA000, 0}), std::nullopt);
}

}  // namespace
}  // namespace cia402::drive
