// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "drive/profile/profile.h"
#include "fieldbus/object_access.h"

namespace cia402::drive {

/// What a drive tells of an error besides its code (ErrorDetails): read once when the error comes.
class FaultDetails {
 public:
  /// Once a cycle. @param code of the fault or warning that stands; 0: none
  void update(const DriveProfile& profile, std::uint16_t code, fieldbus::ObjectAccess& objects);
  /// Something new has come with the same code: it is read again.
  void renew() { code_ = 0; }
  /// Nothing is known, and nothing asked for.
  bool idle() const { return code_ == 0 && !ticket_; }
  /// It is asked for, and the drive has not answered yet.
  bool awaited(std::uint16_t code) const {
    return code != 0 && code == code_ && ticket_ != nullptr;
  }
  /// "E234 runaway (fault_codes (203F:00) 0x02340234): <cause>; <remedy>"; empty where nothing is
  /// known of the error with this code.
  std::string text(const DriveProfile& profile, std::uint16_t code) const;

 private:
  std::uint16_t code_ = 0;               ///< of the error that it belongs to
  std::optional<std::uint64_t> number_;  ///< what the drive has told of it
  fieldbus::Ticket ticket_;
};

/// What a number of ErrorDetails says: "E234 runaway"; "E123" where the profile does not know it.
std::string detailName(const ErrorDetails& details, std::uint64_t number);

}  // namespace cia402::drive
