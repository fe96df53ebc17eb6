// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "fieldbus/emergency.h"

#include <gtest/gtest.h>

namespace cia402::fieldbus {
namespace {

TEST(EmergencyText, prefers_the_most_specific_meaning) {
  EXPECT_EQ(emergencyText(0x8611), "following error");
  EXPECT_EQ(emergencyText(0x3210), "DC link overvoltage");
  EXPECT_EQ(emergencyText(0x8130), "life guard or heartbeat error");
  EXPECT_EQ(emergencyText(0x7305), "incremental encoder 1 fault");
}

TEST(EmergencyText, falls_back_to_the_class_of_the_code) {
  EXPECT_EQ(emergencyText(0x8615), "positioning controller");  // 861xh has no row, 86xxh has
  EXPECT_EQ(emergencyText(0x2399), "current, device output side");
  EXPECT_EQ(emergencyText(0x2311), "continuous overcurrent, device output side");
  EXPECT_EQ(emergencyText(0x6F00), "device software");
  EXPECT_EQ(emergencyText(0xFF42), "manufacturer-specific error");
}

// The error codes of IEC 61800-7-201 and the error classes of CiA 301, table 26.
constexpr std::uint16_t kCodesOfTheStandards[] = {
    0x0000, 0x1000, 0x2000, 0x2100, 0x2110, 0x2120, 0x2121, 0x2122, 0x2123, 0x2130, 0x2131, 0x2132,
    0x2133, 0x2200, 0x2211, 0x2212, 0x2213, 0x2214, 0x2220, 0x2230, 0x2240, 0x2250, 0x2300, 0x2310,
    0x2320, 0x2330, 0x2331, 0x2332, 0x2333, 0x2340, 0x2341, 0x2342, 0x2343, 0x2350, 0x2351, 0x3000,
    0x3100, 0x3110, 0x3120, 0x3130, 0x3131, 0x3132, 0x3133, 0x3134, 0x3140, 0x3141, 0x3142, 0x3200,
    0x3210, 0x3220, 0x3230, 0x3300, 0x3310, 0x3311, 0x3312, 0x3313, 0x3320, 0x3321, 0x3330, 0x3331,
    0x4000, 0x4100, 0x4110, 0x4120, 0x4130, 0x4140, 0x4200, 0x4210, 0x4220, 0x4300, 0x4310, 0x4320,
    0x4400, 0x4410, 0x4420, 0x5000, 0x5100, 0x5110, 0x5111, 0x5112, 0x5113, 0x5120, 0x5200, 0x5210,
    0x5220, 0x5300, 0x5400, 0x5410, 0x5420, 0x5430, 0x5440, 0x5450, 0x5500, 0x5510, 0x5520, 0x5530,
    0x6000, 0x6010, 0x6100, 0x6200, 0x6300, 0x6310, 0x6320, 0x7000, 0x7100, 0x7110, 0x7111, 0x7112,
    0x7113, 0x7120, 0x7121, 0x7122, 0x7123, 0x7200, 0x7300, 0x7301, 0x7302, 0x7303, 0x7304, 0x7305,
    0x7306, 0x7307, 0x7310, 0x7320, 0x7400, 0x7500, 0x7510, 0x7520, 0x7600, 0x8000, 0x8100, 0x8110,
    0x8120, 0x8130, 0x8140, 0x8150, 0x8200, 0x8210, 0x8220, 0x8230, 0x8240, 0x8250, 0x8300, 0x8311,
    0x8312, 0x8313, 0x8321, 0x8331, 0x8400, 0x8500, 0x8600, 0x8611, 0x8612, 0x8700, 0x8800, 0x8900,
    0x8A00, 0x9000, 0xF000, 0xF001, 0xF002, 0xF003, 0xF004, 0xFF00,
};

TEST(EmergencyText, has_words_of_its_own_for_each_code_of_the_standards) {
  for (const std::uint16_t code : kCodesOfTheStandards) {
    if (code == 0) continue;
    // The same code but for its last digit that is not 0: one that there is not.
    unsigned digit = 0;
    while ((code >> digit & 0xF) == 0) digit += 4;
    const auto neighbour = static_cast<std::uint16_t>((code & ~(0xF << digit)) | 0xE << digit);
    EXPECT_NE(emergencyText(code), emergencyText(neighbour)) << std::hex << code;
  }
}

TEST(EmergencyText, tells_the_reset_and_the_unknown) {
  EXPECT_EQ(emergencyText(0x0000), "error reset or no error");
  EXPECT_EQ(emergencyText(0x0012), "error code unknown to CiA 301 and CiA 402");
  EXPECT_EQ(emergencyText(0xA000), "error code unknown to CiA 301 and CiA 402");
}

TEST(ErrorRegisterText, names_the_bits_that_are_set) {
  EXPECT_EQ(errorRegisterText(0x00), "none");
  EXPECT_EQ(errorRegisterText(0x05), "generic, voltage");
  EXPECT_EQ(errorRegisterText(0xA0), "device profile, manufacturer");
}

TEST(VendorBytesText, IsHexadecimalAndEmptyWhereThereIsNothing) {
  Emergency emergency;
  EXPECT_EQ(vendorBytesText(emergency), "");
  emergency.vendor = {0x0A, 0, 0xFF, 0, 1};
  EXPECT_EQ(vendorBytesText(emergency), "0A 00 FF 00 01");
}

}  // namespace
}  // namespace cia402::fieldbus
