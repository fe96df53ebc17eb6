// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/fault_details.h"

#include "common/text.h"
#include "fieldbus/bytes.h"

namespace cia402::drive {
namespace {

const ErrorText* known(const ErrorDetails& details, std::uint64_t number) {
  const auto found = details.codes.find(number & details.bits);
  return found == details.codes.end() ? nullptr : &found->second;
}

}  // namespace

void FaultDetails::update(const DriveProfile& profile, std::uint16_t code,
                          fieldbus::ObjectAccess& objects) {
  const ObjectSpec* object = profile.find(profile.error_details.object);
  if (object == nullptr) return;
  if (code != code_) {
    code_ = code;
    number_.reset();
    ticket_ = code == 0 ? nullptr : objects.upload(object->id, object->name);
  }
  if (!ticket_ || !ticket_->done()) return;
  const bool fits = ticket_->ok() && !ticket_->data().empty() && ticket_->data().size() <= 8;
  if (fits) number_ = fieldbus::toUnsigned(ticket_->data());
  ticket_.reset();
}

std::string FaultDetails::text(const DriveProfile& profile, std::uint16_t code) const {
  const ErrorDetails& details = profile.error_details;
  const ObjectSpec* object = profile.find(details.object);
  const bool told = object != nullptr && code != 0 && code == code_ && number_.value_or(0) != 0;
  if (!told) return {};
  std::string text =
      detailName(details, *number_) + " (" + object->name + " (" + fieldbus::toString(object->id) +
      ") " + hexText(*number_, static_cast<int>(fieldbus::sizeBits(object->type) / 4)) + ")";
  const ErrorText* error = known(details, *number_);
  if (error == nullptr) return text;
  const char* separator = ": ";
  for (const std::string* part : {&error->cause, &error->remedy}) {
    if (part->empty()) continue;
    text += separator + *part;
    separator = "; ";
  }
  return text;
}

std::string detailName(const ErrorDetails& details, std::uint64_t number) {
  const std::string hex = hexText(number & details.bits, details.digits).substr(2);
  const ErrorText* error = known(details, number);
  return details.prefix + hex + (error == nullptr ? "" : " " + error->text);
}

}  // namespace cia402::drive
