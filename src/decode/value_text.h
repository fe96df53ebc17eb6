// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "canopen/sdo/client.h"
#include "drive/axis/config.h"
#include "drive/profile/conversion.h"

namespace cia402::decode {

/// "rad/s", "N m", "V": the unit of a joint for what is measured; nullptr where it has none.
const char* unitOf(drive::Quantity quantity, const drive::AxisConfig& axis);
/// A text without the zeros at its end: drives written in C pad theirs.
fieldbus::Bytes unpadded(fieldbus::Bytes data);
/// Bytes as a quoted text if they are printable, else in hexadecimal; long ones are cut.
std::string bytesText(const fieldbus::Bytes& data);

/// Words for the values of one drive's objects: units of the joint, names of states and modes. With
/// a memory for the mode that the drive shows, by which bits of status- and controlword are named.
class ValueText {
 public:
  /// @param axis with its profile; must outlive it
  explicit ValueText(const drive::AxisConfig& axis);

  /// Does the profile list it?
  bool lists(fieldbus::ObjectId object) const { return find(object) != nullptr; }
  /// Name of an object: the profile's, else that of CiA 301, else nothing.
  std::string name(fieldbus::ObjectId object) const;
  /// "6041:00 statusword".
  std::string title(fieldbus::ObjectId object) const;

  /// A value of so many bits from a PDO: "0.0118 rad (1234)", "0x0237 operation enabled; remote".
  std::string describe(fieldbus::ObjectId object, std::uint64_t raw, unsigned bits) const;
  /// A value that an SDO carried.
  std::string describe(fieldbus::ObjectId object, const fieldbus::Bytes& data) const;
  /// Looks at a value for the mode of operation.
  void note(fieldbus::ObjectId object, std::uint64_t raw);

  const drive::AxisConfig& axis() const { return axis_; }

 private:
  /// What is known of an object.
  struct Known {
    const drive::ObjectSpec* spec = nullptr;  ///< in the profile
    std::optional<drive::Conversion> conversion;
    const char* unit = nullptr;
  };

  const Known* find(fieldbus::ObjectId object) const;
  std::string unnamed(fieldbus::ObjectId object, std::uint64_t raw, unsigned bits) const;
  std::string words(const Known& known, std::uint64_t raw, unsigned bits) const;

  drive::AxisConfig axis_;
  std::map<fieldbus::ObjectId, Known> objects_;
  const drive::ModeSpec* mode_ = nullptr;
};

/// The statusword in words: the state, then the bits that do not belong to it.
/// @param mode names the bits that depend on it; nullptr: unknown.
/// @param words of the family
std::string statuswordText(std::uint16_t statusword, const drive::ModeSpec* mode,
                           const drive::StatusWords& words);
/// The controlword in words: the command (CiA 402-2, table "command coding"), then the other bits.
std::string controlwordText(std::uint16_t controlword, const drive::ModeSpec* mode);
/// "8 cyclic_position".
std::string modeText(int value, const drive::DriveProfile& profile);
/// "0x8611 following error": without cause and remedy.
std::string errorText(std::uint16_t code, const drive::DriveProfile& profile);

}  // namespace cia402::decode
