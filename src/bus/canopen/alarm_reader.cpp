// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/canopen/alarm_reader.h"

#include <algorithm>

#include "drive/profile/conversion.h"
#include "drive/profile/named_write.h"
#include "fieldbus/bytes.h"

namespace cia402::bus {

AlarmReader::AlarmReader(drive::Axis& axis, unsigned most)
    : axis_(&axis), most_(std::min(most, profile().alarm_memory.entries)) {}

void AlarmReader::select(unsigned number, Stage stage) {
  const drive::ObjectSpec& object = *profile().find(profile().alarm_memory.select);
  stage_ = stage;
  ticket_ = axis_->device().objects().download(object.id, drive::wireBytes(number, object.type),
                                               object.name);
}

void AlarmReader::read(const std::string& object, Stage stage) {
  const drive::ObjectSpec& spec = *profile().find(object);
  stage_ = stage;
  ticket_ = axis_->device().objects().upload(spec.id, spec.name);
}

bool AlarmReader::step() {
  if (stage_ == Stage::begin) {
    select(0, Stage::selecting);
    return false;
  }
  if (!ticket_->done()) return false;
  if (stage_ == Stage::closing) return true;
  if (ticket_->ok()) return take();
  history_.remark = "alarm " + std::to_string(number_) + " not read: " + ticket_->message();
  if (stage_ == Stage::selecting && number_ == 0) return true;
  select(0, Stage::closing);
  return false;
}

bool AlarmReader::take() {
  const drive::AlarmMemory& memory = profile().alarm_memory;
  const std::uint64_t raw = fieldbus::toUnsigned(ticket_->data());
  switch (stage_) {
    case Stage::selecting:
      history_.readable = true;
      read(memory.code, Stage::code);
      return false;
    case Stage::code:
      if (raw == 0) {  // no more were kept
        select(0, Stage::closing);
        return false;
      }
      history_.entries.push_back({static_cast<std::uint16_t>(raw), 0, {}, {}});
      history_.recorded = number_ + 1;
      if (memory.time.empty()) return next();
      read(memory.time, Stage::time);
      return false;
    case Stage::time: {
      const auto conversion = drive::Conversion::create(*profile().find(memory.time), profile(),
                                                        axis_->config().geometry);
      if (conversion) history_.entries.back().time = conversion->toJoint(raw);
      return next();
    }
    case Stage::begin:
    case Stage::closing:
      break;
  }
  return true;
}

bool AlarmReader::next() {
  const bool more = ++number_ < most_;
  select(more ? number_ : 0, more ? Stage::selecting : Stage::closing);
  return false;
}

}  // namespace cia402::bus
