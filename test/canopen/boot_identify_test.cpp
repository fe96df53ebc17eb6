// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/node_fixture.h"

namespace cia402::canopen {
namespace {

using test::kAskDeviceType;
using test::kAskVendor;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class BootIdentifyTest : public test::NodeFixture {};

TEST_F(BootIdentifyTest, a_device_type_that_is_refused_matters_only_if_configured) {
  peer.replace(kAskDeviceType, "583 80 00 10 00 00 00 00 08");
  boot();
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_THAT(node->notes(), ElementsAre(HasSubstr("its device type is unknown: reading 1000:00")));
  peer.take();
  config.device_type = 0x00020192;
  boot();
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_THAT(node->problem(), HasSubstr("boot failed while reading 1000:00 device type: the drive "
                                         "refused: 0x08000000"));
  EXPECT_FALSE(sentLine(kAskVendor)) << "who it is is not known";
}

}  // namespace
}  // namespace cia402::canopen
