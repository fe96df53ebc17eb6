// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/bus/jobs.h"
#include "cia402_driver/bus/object_text.h"

namespace cia402::bus {

Result<ObjectJob> ObjectJob::find(drive::Axis& axis, const std::string& object, Reply reply) {
  ObjectJob job;
  job.axis_ = &axis;
  job.reply_ = std::move(reply);
  const drive::AxisConfig& config = axis.config();
  job.who_ = drive::whoIs(config);
  job.spec_ = config.profile->find(object);
  if (job.spec_ != nullptr) {
    job.id_ = job.spec_->id;
  } else if (const auto id = canopen::parseObjectId(object)) {
    job.id_ = *id;
    job.spec_ = config.profile->find(*id);
  } else {
    std::string why;
    if (config.eds != nullptr) {
      const auto found = config.eds->dictionary.find(object);
      if (!found) why = " (" + config.eds->file + ": " + found.error().message + ")";
    }
    return Error{job.who_ + ": \"" + object + "\" is neither an object of profile " +
                 config.profile->name + " nor an index such as 6041:00" + why};
  }
  job.name_ = canopen::toString(job.id_) + (job.spec_ ? " " + job.spec_->name : "");
  return job;
}

Result<ObjectJob> ObjectJob::read(drive::Axis& axis, const std::string& object, Reply reply) {
  Result<ObjectJob> job = find(axis, object, std::move(reply));
  if (job) {
    job.value().ticket_ = axis.node().sdo().upload(job.value().id_, job.value().name_);
  }
  return job;
}

Result<ObjectJob> ObjectJob::write(drive::Axis& axis, const std::string& object,
                                   const std::string& value, Reply reply) {
  Result<ObjectJob> found = find(axis, object, std::move(reply));
  if (!found) return found;
  ObjectJob& job = found.value();
  job.value_ = value;
  if (job.spec_ == nullptr) {
    job.stage_ = Stage::asking_size;
    job.ticket_ = axis.node().sdo().upload(job.id_, job.name_);
    return found;
  }
  const Result<canopen::Bytes> data = encodeObject(*job.spec_, value);
  if (!data) return Error{job.who_ + ": " + job.name_ + " not written: " + data.error().message};
  if (const auto& eds = axis.config().eds) {
    const canopen::DictionaryEntry* entry = eds->dictionary.find(job.id_);
    const auto allowed =
        entry != nullptr ? canopen::checkWrite(*entry, *data, eds->file) : Result<void>();
    if (!allowed) {
      return Error{job.who_ + ": " + job.name_ + " not written: " + allowed.error().message};
    }
  }
  job.stage_ = Stage::writing;
  job.ticket_ = axis.node().sdo().download(job.id_, *data, job.name_);
  return found;
}

bool ObjectJob::step() {
  if (!ticket_->done()) return false;
  if (!ticket_->ok()) {
    return finish(false, who_ + ": " + name_ +
                             (stage_ == Stage::reading ? " not read: " : " not written: ") +
                             ticket_->reason());
  }
  switch (stage_) {
    case Stage::reading:
      return finishRead();
    case Stage::asking_size:
      return writeWithAskedSize();
    case Stage::writing:
      break;
  }
  return finish(true, who_ + ": wrote " + value_ + " to " + name_);
}

bool ObjectJob::finishRead() {
  const auto unnamed = unnamedFloat();
  const ObjectText text =
      describeObject(unnamed ? &*unnamed : spec_, axis_->config(), ticket_->data());
  Answer answer;
  answer.success = true;
  answer.message = who_ + ": " + name_ + " is " + text.value;
  answer.data = ticket_->data();
  answer.number = text.number;
  answer.text = text.value;
  if (reply_) reply_(answer);
  return true;
}

std::optional<drive::ObjectSpec> ObjectJob::unnamedFloat() const {
  if (spec_ != nullptr) return {};
  return axis_->config().profile->unnamedFloat(id_, ticket_->data().size());
}

bool ObjectJob::writeWithAskedSize() {
  const auto unnamed = unnamedFloat();
  const Result<canopen::Bytes> data =
      unnamed ? encodeObject(*unnamed, value_) : encodeUnlisted(value_, ticket_->data().size());
  if (!data) return finish(false, who_ + ": " + name_ + " not written: " + data.error().message);
  stage_ = Stage::writing;
  ticket_ = axis_->node().sdo().download(id_, *data, name_);
  return false;
}

bool ObjectJob::finish(bool success, std::string message) {
  Answer answer;
  answer.success = success;
  answer.message = std::move(message);
  if (reply_) reply_(answer);
  return true;
}

}  // namespace cia402::bus
