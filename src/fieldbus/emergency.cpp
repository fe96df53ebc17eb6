// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "fieldbus/emergency.h"

#include <algorithm>

#include "common/text.h"

namespace cia402::fieldbus {
namespace {

struct CodeWords {
  std::uint16_t code;
  const char* words;
};

/// Error classes of CiA 301, table 26, and error codes of CiA 402 (IEC 61800-7-201), by number.
/// A code ending in zeros stands for all codes that begin like it and have no row of their own.
constexpr CodeWords kCodes[] = {
    {0x0000, "error reset or no error"},
    {0x1000, "generic error"},
    {0x2000, "current"},
    {0x2100, "current, device input side"},
    {0x2110, "short circuit or earth leakage, device input side"},
    {0x2120, "earth leakage, device input side"},
    {0x2121, "earth leakage, phase L1"},
    {0x2122, "earth leakage, phase L2"},
    {0x2123, "earth leakage, phase L3"},
    {0x2130, "short circuit, device input side"},
    {0x2131, "short circuit, phases L1-L2"},
    {0x2132, "short circuit, phases L2-L3"},
    {0x2133, "short circuit, phases L3-L1"},
    {0x2200, "current inside the device"},
    {0x2211, "current inside the device, no. 1"},
    {0x2212, "current inside the device, no. 2"},
    {0x2213, "overcurrent in ramp function"},
    {0x2214, "overcurrent in the sequence"},
    {0x2220, "continuous overcurrent inside the device"},
    {0x2230, "short circuit or earth leakage inside the device"},
    {0x2240, "earth leakage inside the device"},
    {0x2250, "short circuit inside the device"},
    {0x2300, "current, device output side"},
    {0x2310, "continuous overcurrent, device output side"},
    {0x2320, "short circuit or earth leakage, motor side"},
    {0x2330, "earth leakage, motor side"},
    {0x2331, "earth leakage, phase U"},
    {0x2332, "earth leakage, phase V"},
    {0x2333, "earth leakage, phase W"},
    {0x2340, "short circuit, motor side"},
    {0x2341, "short circuit, phases U-V"},
    {0x2342, "short circuit, phases V-W"},
    {0x2343, "short circuit, phases W-U"},
    {0x2350, "load level fault (I2t, thermal state)"},
    {0x2351, "load level warning (I2t, thermal state)"},
    {0x3000, "voltage"},
    {0x3100, "mains voltage"},
    {0x3110, "mains overvoltage"},
    {0x3120, "mains undervoltage"},
    {0x3130, "mains phase failure"},
    {0x3131, "mains phase failure L1"},
    {0x3132, "mains phase failure L2"},
    {0x3133, "mains phase failure L3"},
    {0x3134, "mains phase sequence"},
    {0x3140, "mains frequency"},
    {0x3141, "mains frequency too high"},
    {0x3142, "mains frequency too low"},
    {0x3200, "DC link voltage"},
    {0x3210, "DC link overvoltage"},
    {0x3220, "DC link undervoltage"},
    {0x3230, "load error"},
    {0x3300, "output voltage"},
    {0x3310, "output overvoltage"},
    {0x3311, "output overvoltage, phase U"},
    {0x3312, "output overvoltage, phase V"},
    {0x3313, "output overvoltage, phase W"},
    {0x3320, "armature circuit"},
    {0x3321, "armature circuit interrupted"},
    {0x3330, "field circuit"},
    {0x3331, "field circuit interrupted"},
    {0x4000, "temperature"},
    {0x4100, "ambient temperature"},
    {0x4110, "ambient temperature too high"},
    {0x4120, "ambient temperature too low"},
    {0x4130, "supply air temperature"},
    {0x4140, "air outlet temperature"},
    {0x4200, "device temperature"},
    {0x4210, "device temperature too high"},
    {0x4220, "device temperature too low"},
    {0x4300, "drive temperature"},
    {0x4310, "drive temperature too high"},
    {0x4320, "drive temperature too low"},
    {0x4400, "supply temperature"},
    {0x4410, "supply temperature too high"},
    {0x4420, "supply temperature too low"},
    {0x5000, "device hardware"},
    {0x5100, "supply"},
    {0x5110, "supply voltage too low"},
    {0x5111, "supply +-15 V"},
    {0x5112, "supply +24 V"},
    {0x5113, "supply +5 V"},
    {0x5120, "supply of the intermediate circuit"},
    {0x5200, "control hardware"},
    {0x5210, "measurement circuit"},
    {0x5220, "computing circuit"},
    {0x5300, "operating unit"},
    {0x5400, "power section"},
    {0x5410, "output stages"},
    {0x5420, "brake chopper"},
    {0x5430, "input stages"},
    {0x5440, "contacts"},
    {0x5450, "fuses"},
    {0x5500, "data storage"},
    {0x5510, "working memory (RAM)"},
    {0x5520, "program memory (ROM, EPROM)"},
    {0x5530, "non-volatile memory (EEPROM)"},
    {0x6000, "device software"},
    {0x6010, "software reset (watchdog)"},
    {0x6100, "internal software"},
    {0x6200, "user software"},
    {0x6300, "data set"},
    {0x6310, "loss of parameters"},
    {0x6320, "parameter error"},
    {0x7000, "additional modules"},
    {0x7100, "power"},
    {0x7110, "brake chopper"},
    {0x7111, "brake chopper failure"},
    {0x7112, "brake chopper overcurrent"},
    {0x7113, "brake chopper protective circuit"},
    {0x7120, "motor"},
    {0x7121, "motor blocked"},
    {0x7122, "motor error or commutation malfunction"},
    {0x7123, "motor tilted"},
    {0x7200, "measurement circuit"},
    {0x7300, "sensor"},
    {0x7301, "tachometer fault"},
    {0x7302, "tachometer polarity"},
    {0x7303, "resolver 1 fault"},
    {0x7304, "resolver 2 fault"},
    {0x7305, "incremental encoder 1 fault"},
    {0x7306, "incremental encoder 2 fault"},
    {0x7307, "incremental encoder 3 fault"},
    {0x7310, "speed sensor"},
    {0x7320, "position sensor"},
    {0x7400, "computation circuit"},
    {0x7500, "communication module"},
    {0x7510, "serial interface 1"},
    {0x7520, "serial interface 2"},
    {0x7600, "data storage of a module"},
    {0x8000, "monitoring"},
    {0x8100, "communication"},
    {0x8110, "CAN overrun (objects lost)"},
    {0x8120, "CAN in error passive mode"},
    {0x8130, "life guard or heartbeat error"},
    {0x8140, "recovered from bus-off"},
    {0x8150, "CAN-ID collision"},
    {0x8200, "protocol error"},
    {0x8210, "PDO not processed due to length error"},
    {0x8220, "PDO length exceeded"},
    {0x8230, "DAM MPDO not processed, destination object not available"},
    {0x8240, "unexpected SYNC data length"},
    {0x8250, "RPDO time-out"},
    {0x8300, "torque control"},
    {0x8311, "excess torque"},
    {0x8312, "difficult start-up"},
    {0x8313, "standstill torque"},
    {0x8321, "insufficient torque"},
    {0x8331, "torque fault"},
    {0x8400, "velocity control"},
    {0x8500, "position control"},
    {0x8600, "positioning controller"},
    {0x8611, "following error"},
    {0x8612, "reference limit"},
    {0x8700, "synchronisation controller"},
    {0x8800, "winding controller"},
    {0x8900, "process data monitoring"},
    {0x8A00, "control monitoring"},
    {0x9000, "external error"},
    {0xF000, "additional functions"},
    {0xF001, "deceleration"},
    {0xF002, "sub-synchronous run"},
    {0xF003, "stroke operation"},
    {0xF004, "control of additional functions"},
    {0xFF00, "manufacturer-specific error"},
};

const char* findExact(std::uint16_t code) {
  const auto* const row =
      std::lower_bound(std::begin(kCodes), std::end(kCodes), code,
                       [](const CodeWords& a, std::uint16_t wanted) { return a.code < wanted; });
  return row != std::end(kCodes) && row->code == code ? row->words : nullptr;
}

/// Bits of object 1001h, CiA 301, 7.5.2.2.
constexpr const char* kRegisterBits[8] = {
    "generic",       "current",        "voltage",  "temperature",
    "communication", "device profile", "reserved", "manufacturer",
};

}  // namespace

std::string emergencyText(std::uint16_t code) {
  if (const char* words = findExact(code)) return words;
  for (const unsigned mask : {0xFFF0U, 0xFF00U, 0xF000U}) {
    const auto group = static_cast<std::uint16_t>(code & mask);
    const char* const words = group == 0 ? nullptr : findExact(group);
    if (words != nullptr) return words;
  }
  return "error code unknown to CiA 301 and CiA 402";
}

std::string errorRegisterText(std::uint8_t bits) {
  if (bits == 0) return "none";
  std::string text;
  for (unsigned bit = 0; bit < 8; ++bit) {
    if ((bits >> bit & 1U) == 0) continue;
    append(text, kRegisterBits[bit], ", ");
  }
  return text;
}

std::string vendorBytesText(const Emergency& emergency) {
  const auto& bytes = emergency.vendor;
  if (std::all_of(bytes.begin(), bytes.end(), [](std::uint8_t byte) { return byte == 0; })) {
    return {};
  }
  return hexBytes(bytes.data(), bytes.size());
}

}  // namespace cia402::fieldbus
