// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/error_evidence.h"

#include "fieldbus/object.h"

namespace cia402::drive {
namespace {

constexpr fieldbus::ObjectId kErrorRegister{0x1001, 0};
constexpr Duration kMute =
    std::chrono::seconds(10);  // until a drive that did not answer is asked again

}  // namespace

void ErrorEvidence::onEmergency(const fieldbus::Emergency& emergency, const std::string& excuse,
                                bool shared, Time now) {
  shared_ = shared;
  pending_ = shared ? 0 : emergency.code;
  next_look_ = now + kLook;
  register_ticket_.reset();
  if (emergency.code != 0 && !(faulted_ && now > fault_since_ + kNaming)) {
    emergency_ = {emergency.code, now};
  }
  if (!excuse.empty()) {
    excused_ = emergency.code;
    excuse_ = excuse;
  } else if (emergency.code == excused_) {
    excused_ = 0;
  }
}

const std::string* ErrorEvidence::excuse(std::uint16_t code) const {
  return code != 0 && code == excused_ ? &excuse_ : nullptr;
}

void ErrorEvidence::forget() {
  code_ = pending_ = 0;
  emergency_ = Told();
  object_.at = Time::min();
  read_.reset();
  code_ticket_.reset();
}

void ErrorEvidence::update(const Look& look, fieldbus::ObjectAccess& objects, Time now) {
  if (look.faulted && !faulted_) fault_since_ = now;
  faulted_ = look.faulted;
  // A warning that comes while the drive stands in a fault does not take that one's name.
  const bool beside = faulted_ && look.of_warning && code_ != 0 && now > fault_since_ + kNaming;
  if (look.told && !beside && (!object_known_ || *look.told != object_.code)) {
    const bool in_time = object_known_ && !(faulted_ && now > fault_since_ + kNaming);
    object_ = {*look.told, in_time ? now : Time::min()};
    object_known_ = true;
  }
  readErrorCode(look, objects);
  readErrorRegister(look, objects, now);
  if (faulted_) {
    code_ = nameOfFault();
  } else if (look.warning && object_.code != 0 && (pending_ == 0 || object_.at >= emergency_.at)) {
    code_ = object_.code;
  } else {
    code_ = pending_;
  }
}

bool ErrorEvidence::withFault(const Told& told) const {
  return told.code != 0 && told.at != Time::min() && told.at >= fault_since_ - kAhead;
}

std::uint16_t ErrorEvidence::nameOfFault() const {
  const bool by_emergency = withFault(emergency_), by_object = withFault(object_);
  if (shared_ && by_object) return object_.code;
  if (shared_ && read_ && *read_ != 0) return *read_;
  if (by_object && (!by_emergency || object_.at >= emergency_.at)) return object_.code;
  if (by_emergency) return emergency_.code;
  if (read_ && *read_ != 0) return *read_;
  return object_.code != 0 ? object_.code : emergency_.code;
}

void ErrorEvidence::readErrorCode(const Look& look, fieldbus::ObjectAccess& objects) {
  if (!faulted_ || look.asked == nullptr) {
    read_.reset();
    code_ticket_.reset();
    return;
  }
  if (read_) return;
  if (!code_ticket_) {
    code_ticket_ = objects.upload(look.asked->id, look.asked->name);
  } else if (code_ticket_->done()) {
    const bool fits = code_ticket_->ok() && code_ticket_->data().size() <= 8;
    read_ = fits ? static_cast<std::uint16_t>(fieldbus::toUnsigned(code_ticket_->data())) : 0;
  }
}

void ErrorEvidence::readErrorRegister(const Look& look, fieldbus::ObjectAccess& objects, Time now) {
  if (pending_ == 0 || look.faulted || register_missing_) return;
  if (!register_ticket_) {
    if (now < next_look_) return;
    register_ticket_ = objects.upload(kErrorRegister, "error register");
  } else if (register_ticket_->done()) {
    next_look_ = now + (register_ticket_->ok() ? kLook : kMute);
    if (register_ticket_->ok()) {
      if (fieldbus::toUnsigned(register_ticket_->data()) == 0) pending_ = 0;
    } else {
      register_missing_ =
          register_ticket_->failure() == fieldbus::Transfer::Failure::aborted_by_server;
    }
    register_ticket_.reset();
  }
}

}  // namespace cia402::drive
