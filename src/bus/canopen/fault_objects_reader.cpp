// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/canopen/fault_objects_reader.h"

#include <algorithm>

#include "bus/jobs/object_text.h"
#include "common/text.h"
#include "fieldbus/bytes.h"

namespace cia402::bus {

FaultObjectsReader::FaultObjectsReader(drive::Axis& axis, unsigned most)
    : axis_(&axis), most_(std::min<std::size_t>(most, memory().faults.size())) {}

const std::string& FaultObjectsReader::object() const {
  const drive::FaultObject& fault = memory().faults[fault_];
  return part_ == 0 ? fault.code : fault.with[part_ - 1];
}

void FaultObjectsReader::read(const std::string& name) {
  const drive::ObjectSpec& spec = *axis_->config().profile->find(name);
  ticket_ = axis_->device().objects().upload(spec.id, spec.name);
}

bool FaultObjectsReader::step() {
  if (!ticket_) {
    read(object());
    return false;
  }
  if (!ticket_->done()) return false;
  if (ticket_->ok()) return take();
  history_.remark = object() + " not read: " + ticket_->message();
  return true;
}

bool FaultObjectsReader::take() {
  history_.readable = true;
  if (part_ == 0) {
    const std::uint64_t number = fieldbus::toUnsigned(ticket_->data());
    if (number == 0) return true;  // no more were kept
    history_.entries.push_back({static_cast<std::uint16_t>(memory().base | number), 0, {}, {}});
    history_.recorded = static_cast<unsigned>(fault_) + 1;
  } else {
    const drive::ObjectSpec& spec = *axis_->config().profile->find(object());
    std::string value = inJointUnits(spec, axis_->config(), ticket_->data());
    if (value.empty()) value = describeObject(&spec, axis_->config(), ticket_->data()).value;
    append(history_.entries.back().with, spec.name + " " + value, ", ");
  }
  return next();
}

bool FaultObjectsReader::next() {
  if (++part_ > memory().faults[fault_].with.size()) {
    part_ = 0;
    if (++fault_ == most_) return true;
  }
  read(object());
  return false;
}

}  // namespace cia402::bus
